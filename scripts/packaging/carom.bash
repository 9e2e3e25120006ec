# bash completion for carom. Installed as share/bash-completion/completions/carom; or source this file.

# The *PARAMETER names of a deck, each with the = that --define needs behind it
_carom_parameters() {
   [[ -r $1 ]] || return
   awk '/^\*\*/ { next }
        /^\*/ { inside = toupper($0) ~ /^\*PARAMETER/; next }
        inside { sub(/=.*/, ""); gsub(/[ \t]/, ""); if ($0 != "") print $0 "=" }' "$1"
}

# Files whose names match one of the patterns, and folders on the way to them
_carom_files() {
   local pattern
   for pattern in "$@"; do
      compgen -f -X "!$pattern" -- "$current"
   done
   compgen -d -- "$current"
}

# The next word of the cards that begin with the words behind `help`; most names have one or two
_carom_cards() {
   local before="${COMP_WORDS[*]:2:COMP_CWORD-2}" names name
   before=${before,,}${before:+ }
   names=$("${COMP_WORDS[0]}" help --table 2>/dev/null | cut -d ';' -f 1 | tr '[:upper:]' '[:lower:]')
   names=$(while IFS= read -r name; do
      [[ $name == "$before"* ]] && name=${name#"$before"} && printf '%s\n' "${name%% *}"
   done <<<"$names" | sort -u)
   compgen -W "$names" -- "${current,,}"
}

_carom_deck() {
   local word
   for word in "${COMP_WORDS[@]:2}"; do
      [[ $word == *.inp ]] && printf '%s\n' "$word" && return
   done
}

_carom() {
   local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
   local command=${COMP_WORDS[1]} options='' words line
   COMPREPLY=()
   if ((COMP_CWORD == 1)); then
      COMPREPLY=($(compgen -W 'run check help --version --help' -- "$current"))
      return
   fi
   case $command in
   run) options='-o --define --threads --quiet --overwrite --restart --memory --time-limit --json' ;;
   check) options='--explain --define --memory --json' ;;
   help) before='help' ;;
   *) return ;;
   esac
   # the value in --define dt=0.1: the shell makes words of dt, = and 0.1
   [[ $current == = || $before == = ]] && return
   case $before in
   help) words=$(_carom_cards) ;;
   -o | --restart)
      words=$(_carom_files '*.h5' '*.hdf5' '*.hdf' '*.vtkhdf')
      type compopt &>/dev/null && compopt -o filenames 2>/dev/null
      ;;
   --define)
      words=$(compgen -W "$(_carom_parameters "$(_carom_deck)")" -- "$current")
      type compopt &>/dev/null && compopt -o nospace 2>/dev/null
      ;;
   --threads) words=$(compgen -W "$(seq "$(getconf _NPROCESSORS_ONLN)")" -- "$current") ;;
   --memory) words=$(compgen -W '500M 1G 2G 4G 8G 16G' -- "$current") ;;
   --time-limit) return ;;
   *)
      if [[ $current == -* ]]; then
         words=$(compgen -W "$options" -- "$current")
      else
         words=$(_carom_files '*.inp')
         type compopt &>/dev/null && compopt -o filenames 2>/dev/null
      fi
      ;;
   esac
   while IFS= read -r line; do
      [[ -n $line ]] && COMPREPLY+=("$line")
   done <<<"$words"
}

complete -F _carom carom
