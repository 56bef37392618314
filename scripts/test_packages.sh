#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs the packages of scripts/package.sh in a bare Debian 12 and uses them there, as an ordinary user: tools, Python and manual
# where no compiler is; at last the library, by building its example with a compiler.
#
#   scripts/test_packages.sh FOLDER    the folder with the packages; as root, since it makes a root of its own
#
# Environment: PAMR_MIRROR, PAMR_TEST_ROOT (see scripts/package.sh).
set -euo pipefail

packages=$(cd -- "${1:?expected the folder with the packages}" && pwd)
. "$(dirname -- "${BASH_SOURCE[0]}")/bare_debian.sh"
in_own_mounts "${BASH_SOURCE[0]}" "$@"
if [ -n "${PAMR_TEST_ROOT:-}" ]; then
  bare=$PAMR_TEST_ROOT
else
  bare=$(mktemp -d -t pamr-debian.XXXXXX)
  chmod 755 "$bare" # the user in it has to find its programs
  trap 'leave_bare; rm -rf --one-file-system "$bare"' EXIT
fi
enter_bare bookworm "$bare" "$packages/debootstrap.log"
as_user() {
  chroot --userspec=4321:4321 "$bare" env -i PATH=/usr/bin:/bin HOME=/tmp/user LC_ALL=C.UTF-8 OMPI_MCA_rmaps_base_oversubscribe=1 \
    sh -ec "cd /tmp/user; $1" 2>&1 | tee -a "$packages/test.log"
}
check() { # what, command as the user
  echo "-- $1"
  as_user "$2" || { echo "test_packages.sh: $1: failed" >&2; exit 1; }
}

: >"$packages/test.log"
rm -rf "$bare/tmp/packages" "$bare/tmp/user"
mkdir -p "$bare/tmp/packages" "$bare/tmp/user"
chown 4321:4321 "$bare/tmp/user"
cp "$packages"/*.deb "$bare/tmp/packages"
inside sh -c 'apt-get -q update && apt-get -q -y purge "pamr*" python3-pamr libpamr-dev && apt-get -q -y autoremove' >"$packages/apt.log" 2>&1 ||
  inside apt-get -q update >>"$packages/apt.log" 2>&1

begin=$(date +%s.%N)
inside sh -c 'apt-get -q -y install --no-install-recommends /tmp/packages/pamr_*.deb' >>"$packages/apt.log" 2>&1 || {
  tail -n 20 "$packages/apt.log" >&2
  exit 1
}
installed=$(date +%s.%N)
check "no compiler is there" '! command -v cc && ! command -v c++ && ! command -v cmake'
check "a first mesh, refined" 'pamr-mesh --shape sphere-in-box -o a.hdf && pamr-mark a.hdf -o b.hdf --patch sphere &&
  mpirun -n 2 pamr-refine b.hdf -o c.hdf'
refined=$(date +%s.%N)
echo "apt install ./pamr_*.deb: $(echo "$begin $installed" | awk '{ printf "%.0f", $2 - $1 }') s; then to the first refined mesh:" \
  "$(echo "$installed $refined" | awk '{ printf "%.1f", $2 - $1 }') s"
check "every tool starts" 'for tool in /usr/bin/pamr-*; do
  case $tool in *picture) ;; *) $tool --version | head -n 1; $tool --help >/dev/null ;; esac; done'
check "man pages and completions" 'for tool in /usr/bin/pamr-*; do name=${tool##*/}; test -s /usr/share/man/man1/$name.1.gz ||
  ls /etc/dpkg/dpkg.cfg.d; bash -c ". /usr/share/bash-completion/completions/$name"; done'
check "the first tutorial" '/usr/share/pamr/tutorials/1-stl-to-openfoam/run.sh first && test -s first/foam/constant/polyMesh/points'

if ls "$packages"/python3-pamr_*.deb >/dev/null 2>&1; then
  inside sh -c 'apt-get -q -y install --no-install-recommends /tmp/packages/python3-pamr_*.deb' >>"$packages/apt.log" 2>&1
  check "the Python package on two ranks" "mpirun -n 2 python3 -c 'import pamr
from mpi4py import MPI
mesh = pamr.Mesh.kuhn_cube(MPI.COMM_WORLD, 4)
fine = pamr.refine(mesh, [True] * len(mesh.cells)).mesh
assert fine.n_cells == 8 * 384, fine.n_cells'"
fi
if ls "$packages"/pamr-doc_*.deb >/dev/null 2>&1; then
  inside sh -c 'apt-get -q -y install --no-install-recommends /tmp/packages/pamr-doc_*.deb' >>"$packages/apt.log" 2>&1
  check "the manual" 'test -s /usr/share/doc/pamr/html/index.html || ls /etc/dpkg/dpkg.cfg.d'
fi
if ls "$packages"/libpamr-dev_*.deb >/dev/null 2>&1; then # with what it depends on and a compiler, nothing else
  inside sh -c 'apt-get -q -y install --no-install-recommends /tmp/packages/libpamr-dev_*.deb cmake g++ make' >>"$packages/apt.log" 2>&1 || {
    tail -n 20 "$packages/apt.log" >&2
    exit 1
  }
  check "a program on the library" 'cmake -S /usr/share/pamr/examples -B build >/dev/null && cmake --build build >/dev/null &&
    mpirun -n 2 build/refine_loop loop.hdf && build/refine_loop alone.hdf && cmp loop.hdf alone.hdf && pamr-quality loop.hdf'
fi
inside sh -c 'apt-get -q -y purge pamr libpamr-dev python3-pamr pamr-doc; test ! -e /usr/bin/pamr-refine' >>"$packages/apt.log" 2>&1
echo "the packages work on a bare Debian 12"
