!> Explicit interfaces of the BLAS and LAPACK routines in use.
module blas_interfaces
   use kinds, only: wp
   implicit none
   private

   public :: ddot, daxpy, dgemv, dgemm, dtrsm, dgesv, dposv, dsygv
   public :: zdotu, zaxpy, zgesv

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

      pure subroutine dgemv(trans, m, n, alpha, a, lda, x, incx, beta, y, incy)
         import :: wp
         implicit none
         character(len=1), intent(in) :: trans
         integer, intent(in) :: m, n, lda, incx, incy
         real(wp), intent(in) :: alpha, beta, a(lda, *), x(*)
         real(wp), intent(inout) :: y(*)
      end subroutine dgemv

      pure subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: wp
         implicit none
         character(len=1), intent(in) :: transa, transb
         integer, intent(in) :: m, n, k, lda, ldb, ldc
         real(wp), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
         real(wp), intent(inout) :: c(ldc, *)
      end subroutine dgemm

      pure subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
         import :: wp
         implicit none
         character(len=1), intent(in) :: side, uplo, transa, diag
         integer, intent(in) :: m, n, lda, ldb
         real(wp), intent(in) :: alpha, a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
      end subroutine dtrsm

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

      pure function zdotu(n, x, incx, y, incy) result(dot)
         import :: wp
         implicit none
         integer, intent(in) :: n, incx, incy
         complex(wp), intent(in) :: x(*), y(*)
         complex(wp) :: dot
      end function zdotu

      pure subroutine zaxpy(n, alpha, x, incx, y, incy)
         import :: wp
         implicit none
         integer, intent(in) :: n, incx, incy
         complex(wp), intent(in) :: alpha, x(*)
         complex(wp), intent(inout) :: y(*)
      end subroutine zaxpy

      pure subroutine zgesv(n, nrhs, a, lda, pivots, b, ldb, info)
         import :: wp
         implicit none
         integer, intent(in) :: n, nrhs, lda, ldb
         complex(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: pivots(*), info
      end subroutine zgesv
   end interface

end module blas_interfaces
