# SPDX-License-Identifier: GPL-3.0-or-later
# The peers' packages, whether they are there, and how their programs are built: for compare.sh and quality_peers.sh, which
# set `here` (this folder) and `results` (where programs go).
# shellcheck shell=bash disable=SC2034,SC2154
python=${PAMR_PEER_PYTHON:-/usr/bin/python3}
compiler=${PAMR_PEER_CXX:-mpicxx}
export OMP_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_btl_vader_single_copy_mechanism=none

declare -A packages=(
  [netgen]="libnglib-dev netgen-headers libopenmpi-dev"
  [dolfinx]="python3-dolfinx python3-numpy"
  [ug]="libdune-uggrid-dev libdune-grid-dev libopenmpi-dev pkg-config"
  [dmplex]="python3-petsc4py python3-numpy"
  [gmsh]="python3-gmsh python3-numpy"
)

is_installed() {
  case $1 in
    netgen) command -v "$compiler" >/dev/null && [ -e /usr/include/netgen/meshing/meshclass.hpp ] ;;
    dolfinx) "$python" -c 'import dolfinx, mpi4py, numpy' ;;
    ug) command -v "$compiler" >/dev/null && [ -e /usr/include/dune/grid/uggrid.hh ] && [ -e /usr/include/dune/uggrid/gm/gm.h ] ;;
    dmplex) "$python" -c 'import petsc4py.PETSc, numpy' ;;
    gmsh) "$python" -c 'import gmsh, numpy' ;;
  esac 2>/dev/null
}

build_peer() { # NAME OPTIONS...: from compare/NAME_peer.cpp to $results/NAME_peer
  local name=$1
  shift
  "$compiler" -std=c++17 -O2 -w "$here/${name}_peer.cpp" -o "$results/${name}_peer" "$@"
}

# netgen's library is built with MPI, which shows in the layout of its mesh class.
build_netgen() {
  local folder version
  folder=/usr/lib/$("$compiler" -print-multiarch)/netgen
  version=$(basename -- "$(readlink -f "$folder/libmesh.so")")
  build_peer netgen -DPARALLEL "-DNETGEN_VERSION_NAME=\"${version#libmesh.so.}\"" \
    -I/usr/include/netgen -I/usr/include/netgen/include "-L$folder" "-Wl,-rpath,$folder" -lmesh -linterface -lngcore
}

# Debian's library is the parallel one (ModelP); without its definitions the headers describe another.
build_ug() {
  build_peer ug -DHAVE_DUNE_UGGRID=1 -DHAVE_MPI=1 -DENABLE_MPI=1 -DModelP -DNDEBUG \
    "-DUG_VERSION_NAME=\"$(pkg-config --modversion dune-uggrid)\"" -ldunegrid -lduneuggrid -ldunegeometry -ldunecommon
}
