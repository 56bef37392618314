#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Everything between a fresh Debian 12 and a built PAMR: packages, configuration, build. What is there already costs
# nothing: a second run starts neither apt nor a configuration.
#
#   scripts/setup.sh [--only "TOOL..."] [--tests] [--python] [--picture] [--manual] [--packages] [--packages-only]
#
#   --only "TOOL..." install and build what these tools need (default: the library and all tools)
#   --tests          build the tests and benchmarks too
#   --python         also install what the Python package needs, and build it (--tests does so too)
#   --picture        also install what pamr-picture needs
#   --manual         also install what docs/build.sh needs
#   --packages       also install what scripts/package.sh needs
#   --packages-only  install, then stop
#
# Environment: PAMR_BUILD (build folder, default build/release), PAMR_JOBS (compilers at once), CI (when set, compiler
# warnings are errors).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${PAMR_BUILD:-$root/build/release}

# What all of PAMR needs, and which part needs what beside it.
packages=(
  build-essential cmake ninja-build       # compiler and build
  libopenmpi-dev openmpi-bin              # MPI
  libhdf5-openmpi-dev                     # files
  libptscotch-dev libscotch-dev libbz2-dev liblzma-dev zlib1g-dev  # partitions
  libcgal-dev                             # geometry (brings Boost, GMP and MPFR)
  libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev  # command line, case files, reports
  libpugixml-dev                          # files of VTK in XML
  python3                                 # tables of the cases
)
declare -A packages_of=(
  [pamr-dsmc]="librandom123-dev"          # random numbers
  [pamr-pb]="petsc-dev pkgconf"           # PETSc with real numbers (brings hypre)
  [pamr-surface]="libopenmesh-dev libeigen3-dev"  # surface meshes
  # STEP and IGES files, which all tools that read surfaces take if it is there
  [cad]="libocct-data-exchange-dev libocct-modeling-algorithms-dev libocct-modeling-data-dev libocct-foundation-dev"
)
python_packages=(python3-dev python3-numpy python3-mpi4py pybind11-dev)
test_packages=(libgtest-dev libgmock-dev libbenchmark-dev python3-gmsh python3-h5py python3-meshio python3-petsc4py cgns-convert help2man
  "${python_packages[@]}"
  chromium                           # the page of pamr-quality --html, looked at
  clang-format clang-tidy codespell) # the gates of .ci/run
picture_packages=(python3-vtk9 python3-matplotlib python3-h5py python3-numpy python3-meshio xvfb) # pamr-picture
manual_packages=(doxygen furo python3-breathe python3-myst-parser python3-sphinx)          # docs/build.sh
packaging_packages=(debhelper debootstrap dh-python dpkg-dev file git help2man lintian xz-utils)  # scripts/package.sh

only=
with_tests=OFF
with_python=no
packages_only=no
has_more=no # packages than there were when the build folder was configured
while [ $# -gt 0 ]; do
  case $1 in
    --only) only=${2:?"setup.sh: --only: expected names of tools, found none"} && shift ;;
    --tests) with_tests=ON packages+=("${test_packages[@]}" "${picture_packages[@]}" "${manual_packages[@]}") ;;
    --python) with_python=yes packages+=("${python_packages[@]}") ;;
    --picture) packages+=("${picture_packages[@]}") ;;
    --manual) packages+=("${manual_packages[@]}") ;;
    --packages) packages+=("${packaging_packages[@]}") ;;
    --packages-only) packages_only=yes ;;
    -h | --help) sed -n '3,18s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "setup.sh: unknown option $1 (see setup.sh --help)" >&2; exit 2 ;;
  esac
  shift
done
[ $with_tests = OFF ] && [ $with_python = no ] || only=
for part in "${!packages_of[@]}"; do
  # shellcheck disable=SC2206  # names of packages have no blanks
  case " ${only:-$part} " in *" $part "*) packages+=(${packages_of[$part]}) ;; esac
done

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

install_packages() {
  local missing=() package as_root=()
  if ! command -v dpkg-query >/dev/null; then
    echo "setup.sh: this is no Debian system; needed are, under Debian's names: $*" >&2
    return 0
  fi
  for package in "$@"; do is_installed "$package" || missing+=("$package"); done
  [ ${#missing[@]} -gt 0 ] || return 0
  echo "setup.sh: installing ${missing[*]}"
  has_more=yes
  if [ "$(id -u)" != 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "setup.sh: expected to be root or to have sudo; install these packages first: ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300
    -o Acquire::Retries=3)
  "${apt[@]}" update
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}"
}

# One compiler per core, as far as memory goes: the geometry sources (CGAL) need up to 1.4 GB each.
parallel_jobs() {
  local cores fitting
  cores=$(nproc)
  fitting=$(awk '/^MemAvailable:/ { print int($2 / 1400000) }' /proc/meminfo)
  [ "$fitting" -ge 1 ] || fitting=1
  echo $((cores < fitting ? cores : fitting))
}

# Whether the build folder was configured for this checkout with all that is asked for now.
is_configured() {
  local cache=$build/CMakeCache.txt
  [ $has_more = no ] || return 1
  [ -f "$build/build.ninja" ] && grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache" || return 1
  [ $with_tests = OFF ] || grep -qx 'PAMR_TESTS:BOOL=ON' "$cache" || return 1
  [ $with_python = no ] || grep -q pamr_python "$build/build.ninja" || return 1
  grep -qx 'PAMR_BATCHES:BOOL=ON' "$cache" || return 1
  [ -z "${CI:-}" ] || grep -qx 'PAMR_STRICT:BOOL=ON' "$cache"
}

# Later changes of the build files are noticed by ninja itself.
configure() {
  is_configured && return 0
  local fresh=() tests=$with_tests
  if grep -qx 'PAMR_TESTS:BOOL=ON' "$build/CMakeCache.txt" 2>/dev/null; then tests=ON; fi
  if [ -f "$build/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
    fresh=(--fresh) # made for another checkout
  fi
  (cd -- "$root" && cmake --preset release "${fresh[@]}" -B "$build" -DPAMR_TESTS=$tests \
    -DPAMR_BENCH=$tests -DPAMR_BATCHES=ON -DPAMR_STRICT="${CI:+ON}")
}

install_packages "${packages[@]}"
if [ $packages_only = no ]; then
  configure
  # shellcheck disable=SC2086  # names of targets have no blanks
  cmake --build "$build" --parallel "${PAMR_JOBS:-$(parallel_jobs)}" ${only:+--target $only}
fi
