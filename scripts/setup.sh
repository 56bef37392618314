#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Everything between a fresh Debian 12 and a built PAMR: packages, configuration, build. What is there already costs
# nothing: a second run starts neither apt nor a configuration.
#
#   scripts/setup.sh [--tests] [--python] [--picture] [--manual] [--packages] [--packages-only]
#
#   --tests          build the tests and benchmarks too (default: library and tools)
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

packages=(
  build-essential cmake ninja-build       # compiler and build
  libopenmpi-dev openmpi-bin              # MPI
  libhdf5-openmpi-dev                     # files
  libptscotch-dev libscotch-dev libbz2-dev liblzma-dev zlib1g-dev  # partitions
  libcgal-dev                             # geometry (brings Boost, GMP and MPFR)
  libcli11-dev libfmt-dev libtomlplusplus-dev nlohmann-json3-dev  # command line, case files, reports
  petsc-dev pkg-config                    # Poisson-Boltzmann solver (PETSc with real numbers, brings hypre)
  libopenmesh-dev libeigen3-dev           # surface meshes of pamr-surface
  libocct-data-exchange-dev libocct-modeling-algorithms-dev libocct-modeling-data-dev libocct-foundation-dev  # STEP and IGES files
  librandom123-dev                        # random numbers of pamr-dsmc
  python3                                 # tables of the cases
)
python_packages=(python3-dev python3-numpy python3-mpi4py pybind11-dev)
test_packages=(libgtest-dev libgmock-dev libbenchmark-dev python3-gmsh python3-h5py python3-meshio python3-petsc4py cgns-convert help2man
  "${python_packages[@]}"
  chromium                           # the page of pamr-quality --html, looked at
  clang-format clang-tidy codespell) # the gates of .ci/run
picture_packages=(python3-vtk9 python3-matplotlib python3-h5py python3-numpy python3-meshio xvfb) # pamr-picture
manual_packages=(doxygen furo python3-breathe python3-myst-parser python3-sphinx)          # docs/build.sh
packaging_packages=(debootstrap dpkg-dev file git help2man xz-utils)                        # scripts/package.sh

with_tests=OFF
with_python=no
batches=ON
[ -z "${CI:-}" ] || batches=OFF # each source is seen to include what it needs
packages_only=no
for option in "$@"; do
  case $option in
    --tests) with_tests=ON packages+=("${test_packages[@]}" "${picture_packages[@]}" "${manual_packages[@]}") ;;
    --python) with_python=yes packages+=("${python_packages[@]}") ;;
    --picture) packages+=("${picture_packages[@]}") ;;
    --manual) packages+=("${manual_packages[@]}") ;;
    --packages) packages+=("${packaging_packages[@]}") ;;
    --packages-only) packages_only=yes ;;
    -h | --help) sed -n '3,17s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    *) echo "setup.sh: unknown option $option (see setup.sh --help)" >&2; exit 2 ;;
  esac
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
  [ -f "$build/build.ninja" ] && grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache" || return 1
  [ $with_tests = OFF ] || grep -qx 'PAMR_TESTS:BOOL=ON' "$cache" || return 1
  [ $with_python = no ] || grep -q pamr_python "$build/build.ninja" || return 1
  grep -qx "PAMR_BATCHES:BOOL=$batches" "$cache" || return 1
  [ -z "${CI:-}" ] || { grep -q '^CMAKE_VERIFY_INTERFACE_HEADER_SETS:.*=ON$' "$cache" &&
    [ -f "$build/compile_commands.json" ]; }
}

# Later changes of the build files are noticed by ninja itself.
configure() {
  is_configured && return 0
  local fresh=()
  if [ -f "$build/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$build/CMakeCache.txt"; then
    fresh=(--fresh) # made for another checkout
  fi
  (cd -- "$root" && cmake --preset release "${fresh[@]}" -B "$build" -DPAMR_TESTS=$with_tests \
    -DPAMR_BENCH=$with_tests -DPAMR_BATCHES=$batches -DPAMR_STRICT="${CI:+ON}" \
    -DCMAKE_VERIFY_INTERFACE_HEADER_SETS="${CI:+ON}")
}

install_packages "${packages[@]}"
if [ $packages_only = no ]; then
  configure
  cmake --build "$build" --parallel "${PAMR_JOBS:-$(parallel_jobs)}"
fi
