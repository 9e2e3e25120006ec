!> Mass, centre and second moments of a body whose mass has been moved within it, restored by the
!> smallest change: the density of element e is multiplied by 1 + p_e with sum m_e p_e^2 least. The
!> moments are the quadratic form of the whole mass matrix in the motions 1, x, y, z along any
!> direction, so kinetic energies of rigid motions are those of before, lumped or consistent; and
!> positive factors keep the matrix positive definite.
module body_moments
   use kinds, only: wp
   use memory_shortage, only: check_allocation
   use element_groups, only: group_type, group_mass
   implicit none
   private

   public :: body_type, restore_moments

   !> Elements with mass that hang together by their nodes.
   type :: body_type
      integer, allocatable :: group(:)           !! (n) index of the group
      integer, allocatable :: element(:)         !! (n) position in the group
      logical :: axial = .false.                 !! axisymmetric: rigid along y only
   end type body_type

   !> Moments of a body over 1 and the coordinates from its middle, by its half size.
   type :: moments_type
      real(wp) :: target(4, 4) = 0.0_wp          !! of the elements' own matrices
      real(wp), allocatable :: now(:, :, :)      !! (4, 4, n) of the elements as they are
   end type moments_type

   !> Second moments (xx, yy, zz, xy, xz, yz) behind mass and first moments.
   integer, parameter :: n_terms = 10

   !> A direction with less than this part of the variance has no extent.
   real(wp), parameter :: flat = 1.0e-14_wp
   real(wp), parameter :: pivot_limit = 1.0e-10_wp
   !> What may be left of a moment, against the body's mass times its size squared.
   real(wp), parameter :: left_over = 1.0e-11_wp
   !> An element keeps this part of its density or the body is too coarse.
   real(wp), parameter :: least_factor = 0.1_wp

contains

   !> Multiplies the mass factors of a body's elements by what restores mass, centre and second
   !> moments; of an axisymmetric body, mass and centre along the axis. If that takes all mass from
   !> an element, of the second moments their sum alone, the polar moment, is restored. Where that
   !> fails too the groups stay as they are and `restored` is false.
   pure subroutine restore_moments(groups, x, body, restored)
      type(group_type), intent(inout) :: groups(:)
      real(wp), intent(in) :: x(:, :)            !! (3, n_nodes of the model)
      type(body_type), intent(in) :: body
      logical, intent(out) :: restored
      type(moments_type) :: moments
      real(wp) :: factor(size(body%group))
      integer :: i, level

      call find_moments(groups, x, body, moments)
      restored = .true.
      if (.not. moments%target(1, 1) > 0.0_wp) return
      do level = 1, 2
         call find_factors(moments, level == 2, body%axial, factor, restored)
         if (restored) exit
      end do
      if (.not. restored) return
      do i = 1, size(factor)
         associate (g => body%group(i), e => body%element(i))
            groups(g)%mass_factor(e) = factor(i)*groups(g)%mass_factor(e)
         end associate
      end do
   end subroutine restore_moments

   !> Moments of every element as it is now, and the body's as it was.
   pure subroutine find_moments(groups, x, body, moments)
      type(group_type), intent(in) :: groups(:)
      real(wp), intent(in) :: x(:, :)
      type(body_type), intent(in) :: body
      type(moments_type), intent(out) :: moments
      real(wp) :: low(3), high(3), along(3), half
      real(wp), allocatable :: own(:, :), now(:, :), p(:, :)
      integer :: i, n, status

      low = huge(low)
      high = -low
      do i = 1, size(body%group)
         associate (nodes => groups(body%group(i))%ien(:, body%element(i)))
            low = min(low, minval(x(:, nodes), 2))
            high = max(high, maxval(x(:, nodes), 2))
         end associate
      end do
      half = maxval(high - low)/2.0_wp
      along = 1.0_wp/half
      if (body%axial) along(1::2) = 0.0_wp
      allocate (moments%now(4, 4, size(body%group)), stat=status)
      call check_allocation(status)
      do i = 1, size(body%group)
         associate (group => groups(body%group(i)), e => body%element(i))
            n = size(group%ien, 1)
            allocate (own(3*n, 3*n), now(3*n, 3*n), p(n, 4), stat=status)
            call check_allocation(status)
            call group%element%mass(e, group%lumped, own)
            call group_mass(group, e, group%lumped, now)
            p(:, 1) = 1.0_wp
            p(:, 2:) = transpose(spread(along, 2, n)*(x(:, group%ien(:, e)) &
                  - spread((low + high)/2.0_wp, 2, n)))
            moments%target = moments%target + matmul(transpose(p), matmul(own(1::3, 1::3), p))
            moments%now(:, :, i) = matmul(transpose(p), matmul(now(1::3, 1::3), p))
            deallocate (own, now, p)
         end associate
      end do
   end subroutine find_moments

   !> Density factors of the elements; `found` if they restore the moments and are positive.
   pure subroutine find_factors(moments, polar, axial, factor, found)
      type(moments_type), intent(in) :: moments
      logical, intent(in) :: polar, axial
      real(wp), intent(out) :: factor(:)
      logical, intent(out) :: found
      real(wp) :: turn(4, 4), term(n_terms, size(factor)), gram(n_terms, n_terms)
      real(wp) :: missing(n_terms), multiplier(n_terms)
      integer :: i, a, pass

      turn = unit_variance(sum(moments%now, 3))
      gram = 0.0_wp
      do i = 1, size(factor)
         term(:, i) = terms_of(moments%now(:, :, i), turn, polar, axial)
         if (.not. term(1, i) > 0.0_wp) cycle
         do a = 1, n_terms
            gram(:, a) = gram(:, a) + term(:, i)*term(a, i)/term(1, i)
         end do
      end do
      factor = 1.0_wp
      do pass = 1, 3
         missing = terms_of(defect_of(moments, factor), turn, polar, axial)
         call solve_semidefinite(gram, missing, multiplier)
         where (term(1, :) > 0.0_wp) factor = factor + matmul(multiplier, term)/term(1, :)
      end do
      found = all(factor > least_factor) &
            .and. is_small(defect_of(moments, factor), polar, axial, left_over*moments%target(1, 1))
   end subroutine find_factors

   !> Moments that the body lacks with some factors.
   pure function defect_of(moments, factor) result(defect)
      type(moments_type), intent(in) :: moments
      real(wp), intent(in) :: factor(:)
      real(wp) :: defect(4, 4)
      integer :: i

      defect = moments%target
      do i = 1, size(factor)
         defect = defect - factor(i)*moments%now(:, :, i)
      end do
   end function defect_of

   !> Affine map of (1, x, y, z) to coordinates of zero mean and unit covariance, by Cholesky's
   !> factor; a direction that adds no extent to the others becomes zero.
   pure function unit_variance(total) result(turn)
      real(wp), intent(in) :: total(4, 4)        !! moments of the body
      real(wp) :: turn(4, 4)
      real(wp) :: factor(4, 4), pivot, limit
      integer :: i, j

      ! Cholesky's factor of all moments has the mean in its first column
      factor = 0.0_wp
      turn = 0.0_wp
      limit = flat*(total(2, 2) + total(3, 3) + total(4, 4))
      do j = 1, 4
         pivot = total(j, j) - sum(factor(j, :j - 1)**2)
         if (.not. pivot > limit) cycle
         factor(j, j) = sqrt(pivot)
         do i = j + 1, 4
            factor(i, j) = (total(i, j) - dot_product(factor(i, :j - 1), factor(j, :j - 1))) &
                  /factor(j, j)
         end do
         turn(j, j) = 1.0_wp
         turn(j, :) = (turn(j, :) - matmul(factor(j, :j - 1), turn(:j - 1, :)))/factor(j, j)
      end do
      turn = turn*sqrt(total(1, 1))
   end function unit_variance

   !> What has to be restored: mass and first moments in the turned coordinates, and there all
   !> second moments or, untransformed, their sum.
   pure function terms_of(moments, turn, polar, axial) result(terms)
      real(wp), intent(in) :: moments(4, 4), turn(4, 4)
      logical, intent(in) :: polar, axial
      real(wp) :: terms(n_terms)
      real(wp) :: turned(4, 4)

      turned = matmul(turn, matmul(moments, transpose(turn)))
      terms = 0.0_wp
      terms(:4) = turned(:, 1)
      if (axial) return
      if (polar) then
         terms(5) = moments(2, 2) + moments(3, 3) + moments(4, 4)
      else
         terms(5:) = [turned(2, 2), turned(3, 3), turned(4, 4), turned(2, 3), turned(2, 4), &
               turned(3, 4)]
      end if
   end function terms_of

   !> Whether no moment is missing that had to be restored.
   pure function is_small(defect, polar, axial, limit) result(small)
      real(wp), intent(in) :: defect(4, 4)
      logical, intent(in) :: polar, axial
      real(wp), intent(in) :: limit
      logical :: small

      small = all(abs(defect(:, 1)) <= limit)
      if (axial) return
      if (polar) then
         small = small .and. abs(defect(2, 2) + defect(3, 3) + defect(4, 4)) <= limit
      else
         small = small .and. all(abs(defect) <= limit)
      end if
   end function is_small

   !> x with A x = b for a positive semidefinite A, zero where A is dependent on the rest.
   pure subroutine solve_semidefinite(matrix, b, x)
      real(wp), intent(in) :: matrix(:, :), b(:)
      real(wp), intent(out) :: x(:)
      real(wp) :: a(size(b), size(b)), r(size(b)), limit
      integer :: order(size(b)), rank, i, j, p
      logical :: used(size(b))

      a = matrix
      r = b
      limit = pivot_limit*maxval([(a(i, i), i=1, size(b))])
      used = .false.
      do rank = 0, size(b) - 1
         p = maxloc([(a(i, i), i=1, size(b))], dim=1, mask=.not. used)
         if (.not. a(p, p) > limit) exit
         used(p) = .true.
         order(rank + 1) = p
         do i = 1, size(b)
            if (used(i)) cycle
            r(i) = r(i) - a(i, p)/a(p, p)*r(p)
            a(i, :) = a(i, :) - a(i, p)/a(p, p)*a(p, :)
         end do
      end do
      x = 0.0_wp
      do j = rank, 1, -1
         p = order(j)
         x(p) = (r(p) - dot_product(a(p, order(j + 1:rank)), x(order(j + 1:rank))))/a(p, p)
      end do
   end subroutine solve_semidefinite

end module body_moments
