!> Explicit interfaces of the ARPACK routines in use.
module arpack_interfaces
   use kinds, only: wp
   implicit none
   private

   public :: dsaupd, dseupd

   interface
      ! ARPACK's own argument lists; arrays come by address, without their size
      subroutine dsaupd(ido, bmat, n, which, nev, tol, resid, ncv, v, ldv, iparam, ipntr, workd, &
            workl, lworkl, info)
         import :: wp
         implicit none
         integer, intent(inout) :: ido, info, iparam(11)
         character(len=1), intent(in) :: bmat
         character(len=2), intent(in) :: which
         integer, intent(in) :: n, nev, ncv, ldv, lworkl
         real(wp), intent(inout) :: tol, resid(n), v(ldv, ncv), workd(3*n), workl(lworkl)
         integer, intent(inout) :: ipntr(11)
      end subroutine dsaupd

      subroutine dseupd(rvec, howmny, select, d, z, ldz, sigma, bmat, n, which, nev, tol, resid, &
            ncv, v, ldv, iparam, ipntr, workd, workl, lworkl, info)
         import :: wp
         implicit none
         logical, intent(in) :: rvec
         character(len=1), intent(in) :: howmny, bmat
         character(len=2), intent(in) :: which
         integer, intent(in) :: ldz, n, nev, ncv, ldv, lworkl
         logical, intent(inout) :: select(ncv)
         real(wp), intent(inout) :: d(nev), z(ldz, nev)
         real(wp), intent(in) :: sigma
         integer, intent(inout) :: iparam(11), ipntr(11), info
         real(wp), intent(inout) :: tol, resid(n), v(ldv, ncv), workd(3*n), workl(lworkl)
      end subroutine dseupd
   end interface

end module arpack_interfaces
