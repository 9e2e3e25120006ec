!> Tables in the result file: a group of equally long columns (time, U1, ...), one dataset each.
!>
!> Rows are gathered in memory and written in blocks, so that appending one costs next to nothing.
!> `flush` writes what is left; it must be called before the file is flushed or closed. A row
!> holds the values of the real columns, then of the integer and of the text columns, each in the
!> order in which the columns were added.
module column_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use errors, only: error_type, new_error, status_internal, status_numerical
   use hdf5_file, only: hdf5_file_type, series_integer, series_real
   use kinds, only: int64, wp
   use text, only: to_text
   use properties, only: name_length
   use memory_shortage, only: check_allocation
   implicit none
   private

   public :: column_table_type, text_length, column_bytes

   !> Characters of a text at most: a contact pair is named by its two surfaces.
   integer, parameter :: text_length = 2*name_length + 1
   integer, parameter :: chunk_rows = 512      ! 4 KiB a chunk of reals
   integer, parameter :: most_rows = 4096      ! rows gathered before they are written
   integer, parameter :: most_values = 2**21   ! 16 MiB of reals gathered at most

   !> The columns of one kind, by their paths in the file.
   type :: columns_type
      integer :: n = 0
      character(len=256), allocatable :: paths(:)
      logical, allocatable :: partial(:)         !! of reals: NaN stands where there is no value
   end type columns_type

   !> A group of columns that grow together.
   type :: column_table_type
      private
      character(len=:), allocatable :: group
      type(columns_type) :: reals, integers, texts
      integer :: n_rows = 0     ! rows appended
      integer :: n_held = 0     ! rows of them still in memory
      logical :: started = .false.
      real(wp), allocatable :: held_reals(:, :)                     ! (row, column)
      integer(int64), allocatable :: held_integers(:, :)            ! (row, column)
      character(len=text_length), allocatable :: held_texts(:, :)   ! (row, column)
   contains
      procedure :: create
      procedure :: add_column
      procedure :: add_integer_column
      procedure :: add_text_column
      procedure :: count_rows
      procedure :: count_columns
      procedure :: cut_back
      procedure :: flush => flush_rows
      generic :: append_row => append_reals, append_mixed
      procedure, private :: append_reals, append_mixed
   end type column_table_type

contains

   !> Makes the group of the table.
   subroutine create(self, file, group, description, error)
      class(column_table_type), intent(out) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: group   !! '/energy', say
      character(len=*), intent(in) :: description
      type(error_type), allocatable, intent(out) :: error   !! status_file

      self%group = group
      call file%create_group(group, description, error)
   end subroutine create

   !> Adds a column of reals; only before the first row.
   subroutine add_column(self, file, path, description, error, partial)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: path   !! in the group: 'time', 'node_5/U1'
      character(len=*), intent(in) :: description
      type(error_type), allocatable, intent(out) :: error   !! status_file
      logical, intent(in), optional :: partial   !! NaN stands where there is no value

      call check_not_started(self, path, error)
      if (allocated(error)) return
      call file%create_series(self%group//'/'//path, series_real, 0, chunk_rows, description, error)
      if (allocated(error)) return
      call remember(self%reals, self%group//'/'//path)
      if (present(partial)) self%reals%partial(self%reals%n) = partial
   end subroutine add_column

   !> Adds a column of integers; only before the first row.
   subroutine add_integer_column(self, file, path, description, error)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: path, description
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call check_not_started(self, path, error)
      if (allocated(error)) return
      call file%create_series(self%group//'/'//path, series_integer, 0, chunk_rows, description, &
            error)
      if (.not. allocated(error)) call remember(self%integers, self%group//'/'//path)
   end subroutine add_integer_column

   !> Adds a column of texts of at most `length` (and 80) characters; only before the first row.
   subroutine add_text_column(self, file, path, length, description, error)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: path, description
      integer, intent(in) :: length
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call check_not_started(self, path, error)
      if (allocated(error)) return
      call file%create_text_series(self%group//'/'//path, length, chunk_rows, description, error)
      if (.not. allocated(error)) call remember(self%texts, self%group//'/'//path)
   end subroutine add_text_column

   !> Rows appended so far, written or not.
   pure integer function count_rows(self)
      class(column_table_type), intent(in) :: self

      count_rows = self%n_rows
   end function count_rows

   pure integer function count_columns(self)
      class(column_table_type), intent(in) :: self

      count_columns = self%reals%n + self%integers%n + self%texts%n
   end function count_columns

   !> Leaves the first rows of a reopened file, to go on behind them.
   subroutine cut_back(self, file, n_rows, short, error)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_rows
      character(len=:), allocatable, intent(out) :: short   !! a column with fewer, if there is one
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call cut_columns(file, self%reals, n_rows, short, error)
      if (allocated(error) .or. allocated(short)) return
      call cut_columns(file, self%integers, n_rows, short, error)
      if (allocated(error) .or. allocated(short)) return
      call cut_columns(file, self%texts, n_rows, short, error)
      self%n_rows = n_rows
   end subroutine cut_back

   subroutine cut_columns(file, columns, n_rows, short, error)
      type(hdf5_file_type), intent(inout) :: file
      type(columns_type), intent(in) :: columns
      integer, intent(in) :: n_rows
      character(len=:), allocatable, intent(out) :: short
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 1, columns%n
         call file%cut(trim(columns%paths(i)), int(n_rows, int64), short, error)
         if (allocated(error) .or. allocated(short)) return
      end do
   end subroutine cut_columns

   !> Appends a row to a table of reals.
   subroutine append_reals(self, file, values, error)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      real(wp), intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error   !! status_file

      call self%append_mixed(file, values, [integer(int64) ::], [character(len=1) ::], error)
   end subroutine append_reals

   !> Appends a row to a table of several kinds of columns.
   subroutine append_mixed(self, file, values, integers, texts, error)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      real(wp), intent(in) :: values(:)
      integer(int64), intent(in) :: integers(:)
      character(len=*), intent(in) :: texts(:)
      !> status_file; a row that does not fit; status_numerical: a value that is not finite
      type(error_type), allocatable, intent(out) :: error

      if (size(values) /= self%reals%n .or. size(integers) /= self%integers%n &
            .or. size(texts) /= self%texts%n) then
         call new_error(error, status_internal, 'a row of '//self%group//' has '// &
               to_text(size(values))//', '//to_text(size(integers))//', '//to_text(size(texts))// &
               ' reals, integers, texts instead of '//to_text(self%reals%n)//', '// &
               to_text(self%integers%n)//', '//to_text(self%texts%n))
         return
      end if
      call check_finite(self, values, error)
      if (allocated(error)) return
      if (.not. self%started) call start(self)
      self%n_held = self%n_held + 1
      self%n_rows = self%n_rows + 1
      self%held_reals(self%n_held, :) = values
      self%held_integers(self%n_held, :) = integers
      self%held_texts(self%n_held, :) = texts
      if (self%n_held == size(self%held_reals, 1)) call self%flush(file, error)
   end subroutine append_mixed

   !> No result is infinite, nor NaN but where there is no value. The first column is the time.
   subroutine check_finite(self, values, error)
      class(column_table_type), intent(in) :: self
      real(wp), intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      ! to compare a NaN is an invalid operation, to ask for one is not
      if (all(ieee_is_finite(values))) return
      do i = 1, size(values)
         if (ieee_is_finite(values(i))) cycle
         if (self%reals%partial(i) .and. ieee_is_nan(values(i))) cycle
         call new_error(error, status_numerical, trim(self%reals%paths(i))//' is not finite (NaN ' &
               //'or infinite) at time '//to_text(values(1))//new_line('a') &
               //'  cure: a smaller step; or other units, so that no number overflows')
         return
      end do
   end subroutine check_finite

   !> Writes the rows held in memory; of those that do not fit on the disk the first ones.
   subroutine flush_rows(self, file, error)
      class(column_table_type), intent(inout) :: self
      type(hdf5_file_type), intent(inout) :: file
      type(error_type), allocatable, intent(out) :: error   !! status_file
      type(error_type), allocatable :: trouble
      integer :: n

      n = self%n_held
      if (n == 0) return
      call file%reserve(bytes_needed(self, n, file%deflate > 0), error)
      if (allocated(error)) then
         do while (n > 0)
            n = n/2
            call file%reserve(bytes_needed(self, n, file%deflate > 0), trouble)
            if (.not. allocated(trouble)) exit
         end do
      end if
      if (n > 0) call write_rows(self, file, n, trouble)
      if (allocated(trouble)) call move_alloc(trouble, error)
      self%n_rows = self%n_rows - (self%n_held - n)
      self%n_held = 0
   end subroutine flush_rows

   !> Writes the first rows of those held in memory, column by column.
   subroutine write_rows(self, file, n, error)
      type(column_table_type), intent(in) :: self
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n
      type(error_type), allocatable, intent(out) :: error   !! status_file
      integer :: column

      do column = 1, self%reals%n
         call file%append(trim(self%reals%paths(column)), self%held_reals(:n, column), error)
         if (allocated(error)) return
      end do
      do column = 1, self%integers%n
         call file%append(trim(self%integers%paths(column)), self%held_integers(:n, column), error)
         if (allocated(error)) return
      end do
      do column = 1, self%texts%n
         call file%append(trim(self%texts%paths(column)), self%held_texts(:n, column), error)
         if (allocated(error)) return
      end do
   end subroutine write_rows

   !> Bytes by which the file grows when the next rows are written: the chunks that they begin, and
   !> their entries in the tables of chunks. A compressed chunk that grows is written anew.
   pure function bytes_needed(self, n, compressed) result(bytes)
      type(column_table_type), intent(in) :: self
      integer, intent(in) :: n                   !! rows
      logical, intent(in) :: compressed
      integer(int64) :: bytes
      integer(int64), parameter :: entry = 256, table = 4096
      integer :: n_chunks, n_written

      n_written = self%n_rows - self%n_held
      n_chunks = (n_written + n + chunk_rows - 1)/chunk_rows &
            - (n_written + chunk_rows - 1)/chunk_rows
      if (compressed) n_chunks = n_chunks + 1
      bytes = n_chunks*((self%reals%n + self%integers%n)*(8_int64*chunk_rows + entry) &
            + self%texts%n*(int(text_length, int64)*chunk_rows + entry))
      if (n_chunks > 0) bytes = bytes + table*(self%reals%n + self%integers%n + self%texts%n)
   end function bytes_needed

   !> Bytes of a column of reals in the file, chunks and what the library writes about it, measured.
   pure real(wp) function column_bytes(rows)
      real(wp), intent(in) :: rows
      real(wp), parameter :: about_it = 2600.0_wp

      column_bytes = 8.0_wp*chunk_rows*real(ceiling(rows/chunk_rows, int64), wp) + about_it
   end function column_bytes

   !> Allocates the memory for the rows; the columns are fixed from here on.
   subroutine start(self)
      type(column_table_type), intent(inout) :: self
      integer :: rows, status

      rows = max(64, min(most_rows, most_values/max(1, self%reals%n)))
      allocate (self%held_reals(rows, self%reals%n), stat=status)
      call check_allocation(status)
      allocate (self%held_integers(rows, self%integers%n), stat=status)
      call check_allocation(status)
      allocate (self%held_texts(rows, self%texts%n), stat=status)
      call check_allocation(status)
      self%started = .true.
   end subroutine start

   subroutine check_not_started(self, path, error)
      class(column_table_type), intent(in) :: self
      character(len=*), intent(in) :: path
      type(error_type), allocatable, intent(out) :: error

      if (self%started) call new_error(error, status_internal, 'column '//path// &
            ' comes after the first row of '//self%group)
   end subroutine check_not_started

   !> Notes the path of a new column, in a list that doubles when it is full.
   pure subroutine remember(columns, path)
      type(columns_type), intent(inout) :: columns
      character(len=*), intent(in) :: path   !! in the file
      character(len=256), allocatable :: longer(:)
      integer :: status

      if (.not. allocated(columns%paths)) then
         allocate (columns%paths(8), columns%partial(8), stat=status)
         call check_allocation(status)
      end if
      if (columns%n == size(columns%paths)) then
         allocate (longer(2*columns%n), stat=status)
         call check_allocation(status)
         longer(:columns%n) = columns%paths
         call move_alloc(longer, columns%paths)
         columns%partial = [columns%partial, columns%partial]
      end if
      columns%n = columns%n + 1
      columns%paths(columns%n) = path
      columns%partial(columns%n) = .false.
   end subroutine remember

end module column_table
