!> Explicit interfaces of the BLAS and LAPACK routines in use.
module blas_interfaces
   use kinds, only: wp
   implicit none
   private

   public :: ddot, daxpy, dgesv, dposv, dsygv

   interface
      pure function ddot(n, x, incx, y, incy) result(dot)
         import :: wp
         implicit none
         integer, intent(in) :: n, incx, incy
         real(wp), intent(in) :: x(*), y(*)
         real(wp) :: dot
      end function ddot

      pure subroutine daxpy(n, alpha, x, incx, y, incy)
         import :: wp
         implicit none
         integer, intent(in) :: n, incx, incy
         real(wp), intent(in) :: alpha, x(*)
         real(wp), intent(inout) :: y(*)
      end subroutine daxpy

      pure subroutine dgesv(n, nrhs, a, lda, pivots, b, ldb, info)
         import :: wp
         implicit none
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: pivots(*), info
      end subroutine dgesv

      pure subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: wp
         implicit none
         character(len=1), intent(in) :: uplo
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dposv

      pure subroutine dsygv(itype, jobz, uplo, n, a, lda, b, ldb, w, work, lwork, info)
         import :: wp
         implicit none
         integer, intent(in) :: itype, n, lda, ldb, lwork
         character(len=1), intent(in) :: jobz, uplo
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         real(wp), intent(out) :: w(*), work(*)
         integer, intent(out) :: info
      end subroutine dsygv
   end interface

end module blas_interfaces
