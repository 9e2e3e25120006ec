# What demo.sh, report.sh, test.sh and .ci/ share: packages, the Python environment, the build. To be sourced
# with $root set to the top of the checkout. Everything it writes stays in there.

build="$root/build"
venv="$root/.venv"
python="$venv/bin/python"
scratch="$root/build/scratch"
# What the tests need beside: CalculiX and its test decks (tests/verification/verify_foreign.py), EGL and
# OpenGL for VTK to draw with (verify_paraview.py), the libraries that gmsh loads (verify_meshes.py)
test_packages='calculix-ccx calculix-ccx-test libegl1 libgl1 libxrender1 libglu1-mesa libxcursor1 libxft2
   libxinerama1 libgomp1'

# Temporary files and caches inside the checkout; the linear algebra of small models on one thread
prepare_environment() {
   rm -rf "$scratch"
   mkdir -p "$scratch"
   export TMPDIR="$scratch" MPLCONFIGDIR="$scratch" XDG_CACHE_HOME="$scratch"
   export OPENBLAS_NUM_THREADS="${OPENBLAS_NUM_THREADS:-1}"
}

say() {
   printf '== %s\n' "$*"
}

fail() {
   printf 'error: %s\n' "$*" >&2
   exit 1
}

has_command() {
   command -v "$1" >/dev/null 2>&1
}

has_package() {
   [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Sets FC to a gfortran of version 12 or later, the given one before all others; false without one
find_fortran() {
   for name in "${FC:-gfortran}" gfortran gfortran-12 gfortran-13 gfortran-14 gfortran-15; do
      has_command "$name" || continue
      version=$("$name" -dumpversion 2>/dev/null) || continue
      [ "${version%%.*}" -ge 12 ] 2>/dev/null || continue
      export FC="$name"
      return 0
   done
   return 1
}

# Sets `missing` to the Debian packages to install: want COMMAND PACKAGE, or want - PACKAGE
want() {
   case $1 in
   -) has_package "$2" || missing="$missing $2" ;;
   *) has_command "$1" || missing="$missing $2" ;;
   esac
}

# OpenBLAS 0.3.20 of Ubuntu 22.04 solves wrongly on processors with AVX512-BF16: not there
blas_package() {
   if grep -qs '^VERSION_CODENAME=jammy' /etc/os-release; then
      has_package libopenblas0-pthread &&
         say 'warning: this OpenBLAS solves wrongly on some processors: remove it if tests fail' >&2
      echo libblas-dev
   else
      echo libopenblas-dev
   fi
}

# Installs what is missing of the Debian packages that carom needs, and of those given
install_packages() {
   has_command apt-get && has_command dpkg-query || {
      find_fortran && has_command cmake && has_command python3 ||
         fail 'no apt-get here: install gfortran >= 12, gcc, make, cmake, HDF5 with Fortran, BLAS,' \
            'LAPACK, ARPACK and Python 3 with venv by hand'
      return 0
   }
   missing=
   want cc gcc
   want - libc6-dev
   want cmake cmake
   want make make
   want - libhdf5-dev
   want - "$(blas_package)"
   want - liblapack-dev
   want - libarpack2-dev
   want - libmumps-seq-dev
   want python3 python3
   python3 -c 'import venv, ensurepip' 2>/dev/null || missing="$missing python3-venv"
   for package in "$@"; do
      want - "$package"
   done
   find_fortran || {
      has_package gfortran || missing="$missing gfortran"
   }
   [ -z "$missing" ] || apt_install $missing
   # Where the usual gfortran is older (Ubuntu 22.04 has 11), version 12 stands beside it
   find_fortran || apt_install gfortran-12
   find_fortran || fail 'no gfortran of version 12 or later'
}

apt_install() {
   as_root=
   if [ "$(id -u)" -ne 0 ]; then
      has_command sudo || fail "these packages are missing, and there is neither root nor sudo to" \
         "install them: $*"
      as_root=sudo
   fi
   say "installing $*"
   if [ -z "${apt_updated:-}" ]; then
      $as_root env -u TMPDIR apt-get update -qq || fail 'apt-get update failed'
      apt_updated=yes
   fi
   # without TMPDIR: apt changes its user, who may not write into the checkout
   $as_root env -u TMPDIR DEBIAN_FRONTEND=noninteractive apt-get install -qq -y \
      --no-install-recommends "$@" >"$scratch/apt.log" 2>&1 || {
      cat "$scratch/apt.log" >&2
      fail "apt-get install $* failed"
   }
}

# Creates .venv and installs the pinned packages of a requirements file, if they are not there yet
make_environment() {
   "$python" -c 'import pip' 2>/dev/null || {
      rm -rf "$venv"
      python3 -m venv "$venv" || fail 'python3 -m venv failed'
   }
   stamp="$venv/$(basename "$(dirname "$1")").installed"
   cat "$root/scripts/requirements.txt" "$1" >"$scratch/requirements"
   cmp -s "$scratch/requirements" "$stamp" && return 0
   say "installing Python packages of ${1#"$root"/} into .venv"
   "$python" -m pip install --quiet --no-cache-dir --disable-pip-version-check -r "$1" ||
      fail "the Python packages of $1 could not be installed"
   cp "$scratch/requirements" "$stamp"
}

# configure_and_build DIRECTORY TARGET [CMAKE OPTIONS]
configure_and_build() {
   directory=$1
   target=$2
   shift 2
   # A build directory remembers where its sources were; after a move it has to go
   if [ -f "$directory/CMakeCache.txt" ]; then
      grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$directory/CMakeCache.txt" ||
         rm -rf "$directory/CMakeCache.txt" "$directory/CMakeFiles"
   fi
   say "building ${directory#"$root"/}"
   cmake -S "$root" -B "$directory" -DPython3_EXECUTABLE="$python" "$@" \
      >"$scratch/configure.log" 2>&1 || {
      cat "$scratch/configure.log" >&2
      fail 'cmake could not configure the build'
   }
   cmake --build "$directory" --target "$target" -j "$(getconf _NPROCESSORS_ONLN)" \
      >"$scratch/build.log" 2>&1 || {
      cat "$scratch/build.log" >&2
      fail 'the build failed'
   }
}

# Builds the program alone, with the Python environment of the scripts, and goes to the top
prepare_program() {
   prepare_environment
   install_packages
   make_environment "$root/scripts/requirements.txt"
   configure_and_build "$build" carom -DCMAKE_BUILD_TYPE=Release
   cd "$root"
}
