# SPDX-License-Identifier: GPL-3.0-or-later
# HDF5 built with MPI, as target `hdf5::hdf5`. CMake's own FindHDF5 asks Debian's compiler wrapper, which fails where
# the path of the build folder has blanks. For an installation elsewhere set ParallelHDF5_ROOT.
find_path(ParallelHDF5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/openmpi hdf5/mpich)
find_library(ParallelHDF5_LIBRARY NAMES hdf5_openmpi hdf5_mpich hdf5)
if(ParallelHDF5_INCLUDE_DIR)
  file(STRINGS ${ParallelHDF5_INCLUDE_DIR}/H5pubconf.h ParallelHDF5_WITH_MPI REGEX "define H5_HAVE_PARALLEL 1")
  file(STRINGS ${ParallelHDF5_INCLUDE_DIR}/H5pubconf.h version REGEX "define H5_VERSION ")
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" ParallelHDF5_VERSION "${version}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ParallelHDF5
  REQUIRED_VARS ParallelHDF5_LIBRARY ParallelHDF5_INCLUDE_DIR ParallelHDF5_WITH_MPI
  VERSION_VAR ParallelHDF5_VERSION
  REASON_FAILURE_MESSAGE "PAMR needs HDF5 built with MPI (Debian: libhdf5-openmpi-dev)")
mark_as_advanced(ParallelHDF5_INCLUDE_DIR ParallelHDF5_LIBRARY)
if(ParallelHDF5_FOUND AND NOT TARGET hdf5::hdf5)
  add_library(hdf5::hdf5 UNKNOWN IMPORTED)
  set_target_properties(hdf5::hdf5 PROPERTIES
    IMPORTED_LOCATION "${ParallelHDF5_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${ParallelHDF5_INCLUDE_DIR}")
endif()
