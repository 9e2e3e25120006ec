!> The one list of keywords: where each may stand, its parameters, what its data lines hold.
module card_rules
   use errors, only: error_type
   use memory_shortage, only: check_allocation
   use places, only: place_type, source_type, fail_at
   use words, only: word_length, squeezed, find_word, advice
   use foreign_words, only: keyword_cure
   use cards, only: card_type, parameter_type, has_parameter, parameter_index
   implicit none
   private

   public :: check_keyword, check_card, usage_of, name_of, is_note_card, n_rules, rule_text

   integer, parameter :: rule_length = 200

   !> keyword ; level ; parameters ; data line, "-" where there is none, "text" where anything goes.
   !! Levels: model, step, both, any; note: accepted without effect.
   !! Parameters: NAME takes no value, NAME= takes one, NAME=! must be given, ~: not yet.
   character(len=rule_length), parameter :: rules(*) = [character(len=rule_length) :: &
         'HEADING;any;;text', &
         'PARAMETER;any;;name = number', &
         'INCLUDE;any;INPUT=!;-', &
         'NODE;model;NSET=;id, x, y[, z]', &
         'NSET;model;NSET=!/GENERATE/ELSET=;node ids and sets, or with GENERATE first, '// &
         'last[, step]; with ELSET none: the nodes of its elements', &
         'ELSET;model;ELSET=!/GENERATE;element ids and sets, or with GENERATE '// &
         'first, last[, step]', &
         'ELEMENT;model;TYPE=!/ELSET=;id, nodes', &
         'SOLID SECTION;model;ELSET=!/MATERIAL=!/ELEMENTS=/BBAR=/OFFSET=;thickness, '// &
         'or area of a truss', &
         'MATERIAL;model;NAME=!;-', &
         'ELASTIC;model;TYPE=;E, nu', &
         'DENSITY;model;;rho', &
         'PLASTIC;model;HARDENING=;yield stress, plastic strain', &
         'DAMPING;model;ALPHA=/BETA=;-', &
         'SPRING;model;ELSET=!/NONLINEAR;the freedoms (none for SPRINGA), then '// &
         'the stiffness, or with NONLINEAR lines of force, elongation', &
         'DASHPOT;model;ELSET=!;the freedoms (none for DASHPOTA), then the coefficient', &
         'MASS;model;ELSET=!;mass', &
         'ELEMENT GROUP;model;ELSET=!/SCHEME=!/MASS=;-', &
         'AMPLITUDE;model;NAME=!/TIME=/DEFINITION=;up to 4 pairs of time, value', &
         'BOUNDARY;both;AMPLITUDE=/TYPE=/OP=;node or set, first dof[, last dof[, value]], or a '// &
         'word such as PINNED in the place of the freedoms', &
         'BASE MOTION;step;AMPLITUDE=!/DOF=!;scale', &
         'INITIAL CONDITIONS;both;TYPE=!;node or set, dof, value', &
         'EQUATION;model;;number of terms, then up to 4 triples of node, dof, coefficient a line', &
         'SURFACE;model;NAME=!/TYPE=;element or set, S1 to S4 (lines without); with '// &
         'TYPE=NODE nodes or node sets', &
         'RIGID SURFACE;model;NAME=!/TYPE=!/AMPLITUDE=;a point (a centre) x, y, z; then the '// &
         'normal nx, ny, nz (the radius); with AMPLITUDE then dx, dy, dz, size', &
         'SURFACE INTERACTION;model;NAME=!;-', &
         'IMPACT;model;METHOD=/RESTITUTION=/RETURN=/SOLUTION=/BETA=/CAPTURE=/MAX EVENTS=/'// &
         'EVENTS=/STIFFNESS=;-', &
         'FRICTION;model;;mu', &
         'CONTACT PAIR;model;INTERACTION=!/TYPE=/PASSES=/MASS=/ADJUST?/SMALL SLIDING;'// &
         'slave surface, master surface', &
         'GAP;model;ELSET=!/INTERACTION=!;clearance[, nx, ny, nz]', &
         'STEP;any;INC=/NAME=/~NLGEOM?/~PERTURBATION;-', &
         'END STEP;any;;-', &
         'STATIC;step;DIRECT/SOLVER=;dt, T[, dt min, dt max]', &
         'DYNAMIC;step;DIRECT/EXPLICIT/GAMMA=/BETA=/ALPHA=/ORDER=/TOLERANCE=/SOLVER=;'// &
         'dt, T[, dt min, dt max]', &
         'FREQUENCY;step;SOLVER=;number of modes[, 0, highest frequency]', &
         'CLOAD;step;AMPLITUDE=/OP=;node or set, dof, force', &
         'DLOAD;step;AMPLITUDE=/OP=;element or set, P1 to P4, BX or BY, value; or GRAV, size, '// &
         'nx, ny, nz; or CENTRIF, omega squared, x, y, z, ax, ay, az', &
         'NODE PRINT;step;NSET=/FREQUENCY=/TOTALS=;U, V, A, RF', &
         'NODE FILE;step;~NSET=/FREQUENCY=/OUTPUT=;U, V, A, RF', &
         'EL PRINT;step;ELSET=/FREQUENCY=/TOTALS=;S, E, PEEQ, ENER', &
         'EL FILE;step;~ELSET=/FREQUENCY=/OUTPUT=;S, E, PEEQ, ENER', &
         'CONTACT PRINT;step;FREQUENCY=/SLAVE=/MASTER=;CF, CDIS', &
         'CONTACT FILE;step;FREQUENCY=;CF, CDIS', &
         'ENERGY PRINT;step;FREQUENCY=/LIMIT=;-', &
         'RESTART;any;WRITE/FREQUENCY=/OVERLAY/READ/STEP=/INC=;-', &
         'PREPRINT;note;;text', &
         'PRINT;note;;text', &
         'OUTPUT;note;COMPRESS?;text', &
         'NODE OUTPUT;note;;text', &
         'ELEMENT OUTPUT;note;;text', &
         'CONTACT OUTPUT;note;;text', &
         'ENERGY OUTPUT;note;;text']

   integer, parameter :: n_rules = size(rules)

contains

   !> A line of the list as it stands above.
   pure function rule_text(rule) result(text)
      integer, intent(in) :: rule
      character(len=:), allocatable :: text

      text = trim(rules(rule))
   end function rule_text

   !> What a data line of a card holds.
   pure function usage_of(rule) result(usage)
      integer, intent(in) :: rule
      character(len=:), allocatable :: usage

      usage = ''
      if (rule > 0) usage = trim(part(rule, 4))
   end function usage_of

   !> The keyword as it is usually written.
   pure function name_of(rule) result(name)
      integer, intent(in) :: rule
      character(len=:), allocatable :: name

      name = '*'//trim(part(rule, 1))
   end function name_of

   !> True for a card that is accepted but cannot change the answer.
   pure function is_note_card(rule) result(note)
      integer, intent(in) :: rule
      logical :: note

      note = part(rule, 2) == 'note'
   end function is_note_card

   !> Looks the keyword up and sets the card's rule.
   pure subroutine check_keyword(card, source, error)
      type(card_type), intent(inout) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: cure

      card%rule = find_word(card%keyword, keywords())
      if (card%rule > 0) return
      cure = keyword_cure(card%keyword)
      if (cure == '') cure = advice(card%keyword, keywords())
      call fail_at(error, source, card%place, "unknown keyword '*"//card%keyword//"'", cure=cure)
   end subroutine check_keyword

   !> Checks level, parameters and the presence of data of a card whose rule is set.
   pure subroutine check_card(card, data, source, behind_step, error)
      type(card_type), intent(in) :: card
      type(place_type), intent(in) :: data(:)   !! the data lines of the deck
      type(source_type), intent(in) :: source
      logical, intent(in) :: behind_step        !! a step has ended or begun before the card
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      do i = 2, size(card%parameters)
         call check_twin(card, i, source, error)
         if (allocated(error)) return
      end do
      if (is_note_card(card%rule)) return
      call check_level(card, source, behind_step, error)
      if (allocated(error)) return
      do i = 1, size(card%parameters)
         call check_parameter(card, i, source, error)
         if (allocated(error)) return
      end do
      call check_required(card, source, error)
      if (allocated(error)) return
      call check_data(card, data, source, error)
   end subroutine check_card

   pure subroutine check_level(card, source, behind_step, error)
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      logical, intent(in) :: behind_step
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: level, name

      level = trim(part(card%rule, 2))
      name = name_of(card%rule)
      if (level == 'model' .and. card%step > 0) then
         call fail_at(error, source, card%place, name//' must not stand inside a step', &
               cure='move it before the first *STEP')
      else if (level == 'step' .and. card%step == 0) then
         call fail_at(error, source, card%place, name//' must stand inside a step', &
               cure='move it between *STEP and *END STEP')
      else if (card%step == 0 .and. behind_step .and. (level == 'model' .or. level == 'both')) then
         call fail_at(error, source, card%place, name//' stands behind a step and would hold ' &
               //'from the start', cure='move it before the first *STEP, or what it says into a step')
      end if
   end subroutine check_level

   pure subroutine check_parameter(card, i, source, error)
      type(card_type), intent(in) :: card
      integer, intent(in) :: i
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), allocatable :: list(:)
      character(len=:), allocatable :: marks, continued
      integer :: k

      continued = ''
      list = parameter_names(card%rule)
      associate (given => card%parameters(i))
         k = find_word(given%name, list)
         if (k == 0) then
            if (given%place%line /= card%place%line) continued = &
                  '; the comma at the end of the line before continues the keyword line'
            call fail_at(error, source, given%place, "unknown parameter '"//given%name// &
                  "' of "//name_of(card%rule), cure=advice(given%name, list)//continued)
            return
         end if
         marks = parameter_marks(card%rule, k)
         if (index(marks, '~') > 0) then
            call fail_at(error, source, given%place, trim(list(k))// &
                  ' is known but does not work yet', cure='remove the parameter')
         else if (index(marks, '=') > 0) then
            call require_value(given, source, error)
         else if (index(marks, '?') == 0 .and. allocated(given%value)) then
            call fail_at(error, source, given%place, trim(list(k))//' takes no value', &
                  cure='write '//trim(list(k))//' alone')
         end if
      end associate
   end subroutine check_parameter

   !> A parameter is given once.
   pure subroutine check_twin(card, i, source, error)
      type(card_type), intent(in) :: card
      integer, intent(in) :: i
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      integer :: j

      associate (given => card%parameters(i))
         do j = 1, i - 1
            if (card%parameters(j)%name /= given%name) cycle
            call fail_at(error, source, given%place, given%name//' is given twice on this card', &
                  cure='keep one of the two')
            return
         end do
      end associate
   end subroutine check_twin

   pure subroutine require_value(given, source, error)
      type(parameter_type), intent(in) :: given
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      logical :: empty

      empty = .not. allocated(given%value)
      if (.not. empty) empty = len_trim(given%value) == 0
      if (empty) call fail_at(error, source, given%place, given%name//' needs a value', &
            cure='write '//given%name//'=value')
   end subroutine require_value

   pure subroutine check_required(card, source, error)
      type(card_type), intent(in) :: card
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=word_length), allocatable :: list(:)
      integer :: k

      list = parameter_names(card%rule)
      do k = 1, size(list)
         if (index(parameter_marks(card%rule, k), '!') == 0) cycle
         if (has_parameter(card, squeezed(list(k)))) cycle
         call fail_at(error, source, card%place, name_of(card%rule)// &
               ' needs the parameter '//trim(list(k)), cure='write '//trim(list(k))//'=value')
         return
      end do
   end subroutine check_required

   pure subroutine check_data(card, data, source, error)
      type(card_type), intent(in) :: card
      type(place_type), intent(in) :: data(:)
      type(source_type), intent(in) :: source
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: optional_data(*) = [character(len=word_length) :: &
            'STATIC', 'BASE MOTION', 'SOLID SECTION', 'HEADING', 'PARAMETER']
      character(len=:), allocatable :: usage, cure

      usage = usage_of(card%rule)
      if (card%keyword == 'NSET' .and. has_parameter(card, 'ELSET')) usage = '-'
      if (usage == '-' .and. card%last >= card%first) then
         call fail_at(error, source, data(card%first), name_of(card%rule)// &
               ' takes no data lines', cure='remove the line, or put its keyword before it')
      end if
      if (usage == '-' .or. card%last >= card%first) return
      if (find_word(card%keyword, optional_data) > 0 .or. removes_all(card)) return
      cure = 'a line is: '//usage
      if (find_word('OP', parameter_names(card%rule)) > 0) cure = cure &
            //'; OP=NEW without lines removes those before'
      call fail_at(error, source, card%place, name_of(card%rule)//' has no data lines', cure=cure)
   end subroutine check_data

   !> OP=NEW, which needs no data lines: what was before is removed, nothing comes in its place.
   pure function removes_all(card) result(removes)
      type(card_type), intent(in) :: card
      logical :: removes
      integer :: i

      removes = .false.
      i = parameter_index(card, 'OP')
      if (i > 0) removes = squeezed(card%parameters(i)%value) == 'NEW'
   end function removes_all

   !> The k-th of the parts between semicolons; the last one keeps its own.
   pure function part(rule, k) result(string)
      integer, intent(in) :: rule, k
      character(len=rule_length) :: string
      integer :: i, cut

      string = rules(rule)
      do i = 1, k - 1
         cut = index(string, ';')
         string = string(cut + 1:)
      end do
      if (k < 4) string = string(:index(string, ';') - 1)
   end function part

   pure function keywords() result(list)
      character(len=word_length) :: list(size(rules))
      integer :: i

      do i = 1, size(rules)
         list(i) = rules(i)(:index(rules(i), ';') - 1)
      end do
   end function keywords

   !> Names of the parameters of a rule.
   pure function parameter_names(rule) result(list)
      integer, intent(in) :: rule
      character(len=word_length), allocatable :: list(:)
      character(len=word_length) :: word
      integer :: k, n, status

      n = parameter_count(rule)
      allocate (list(n), stat=status)
      call check_allocation(status)
      do k = 1, n
         word = parameter_word(rule, k)
         if (word(1:1) == '~') word = word(2:)
         list(k) = word(:scan(word//'=', '=?!') - 1)
      end do
   end function parameter_names

   !> The signs =, !, ? and ~ that stand with a parameter.
   pure function parameter_marks(rule, k) result(marks)
      integer, intent(in) :: rule, k
      character(len=word_length) :: marks
      character(len=word_length) :: word

      word = parameter_word(rule, k)
      marks = word(scan(word//'=', '=?!'):)
      if (word(1:1) == '~') marks = '~'//marks(:word_length - 1)
   end function parameter_marks

   pure function parameter_count(rule) result(n)
      integer, intent(in) :: rule
      integer :: n
      character(len=rule_length) :: string
      integer :: i

      string = part(rule, 3)
      n = 0
      if (string == '') return
      n = 1
      do i = 1, len_trim(string)
         if (string(i:i) == '/') n = n + 1
      end do
   end function parameter_count

   pure function parameter_word(rule, k) result(word)
      integer, intent(in) :: rule, k
      character(len=word_length) :: word
      character(len=rule_length) :: string
      integer :: i

      string = part(rule, 3)
      do i = 1, k - 1
         string = string(index(string, '/') + 1:)
      end do
      if (index(string, '/') > 0) string = string(:index(string, '/') - 1)
      word = string(:word_length)
   end function parameter_word

end module card_rules
