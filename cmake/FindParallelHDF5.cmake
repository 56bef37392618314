# SPDX-License-Identifier: GPL-3.0-or-later
# HDF5 built with MPI, as target `hdf5::hdf5`. CMake's own FindHDF5 asks Debian's compiler wrapper, which fails where
# the path of the build folder has blanks. For an installation elsewhere set ParallelHDF5_ROOT.
include(${CMAKE_CURRENT_LIST_DIR}/mpi_family.cmake)
set(families ${PAMR_MPI_FAMILY})
if(NOT families)
  set(families openmpi mpich)
endif()
list(TRANSFORM families PREPEND hdf5/ OUTPUT_VARIABLE suffixes)
list(TRANSFORM families PREPEND hdf5_ OUTPUT_VARIABLE names)
find_path(ParallelHDF5_INCLUDE_DIR hdf5.h PATH_SUFFIXES ${suffixes})
find_library(ParallelHDF5_LIBRARY NAMES ${names} hdf5 NAMES_PER_DIR) # that of ParallelHDF5_ROOT before Debian's, as its headers
pamr_is_of_this_mpi("${ParallelHDF5_LIBRARY}" ParallelHDF5_OF_THIS_MPI)
if(ParallelHDF5_INCLUDE_DIR)
  file(STRINGS ${ParallelHDF5_INCLUDE_DIR}/H5pubconf.h ParallelHDF5_WITH_MPI REGEX "define H5_HAVE_PARALLEL 1")
  file(STRINGS ${ParallelHDF5_INCLUDE_DIR}/H5pubconf.h version REGEX "define H5_VERSION ")
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" ParallelHDF5_VERSION "${version}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ParallelHDF5
  REQUIRED_VARS ParallelHDF5_LIBRARY ParallelHDF5_INCLUDE_DIR ParallelHDF5_WITH_MPI ParallelHDF5_OF_THIS_MPI
  VERSION_VAR ParallelHDF5_VERSION
  REASON_FAILURE_MESSAGE "PAMR needs HDF5 built with MPI, the one that its compiler uses (Debian: libhdf5-openmpi-dev, for MPICH libhdf5-mpich-dev)")
mark_as_advanced(ParallelHDF5_INCLUDE_DIR ParallelHDF5_LIBRARY)
if(ParallelHDF5_FOUND AND NOT TARGET hdf5::hdf5)
  add_library(hdf5::hdf5 UNKNOWN IMPORTED)
  set_target_properties(hdf5::hdf5 PROPERTIES
    IMPORTED_LOCATION "${ParallelHDF5_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${ParallelHDF5_INCLUDE_DIR}")
  if(ParallelHDF5_LIBRARY MATCHES "[.]a$") # a static one does not say what it needs
    set_target_properties(hdf5::hdf5 PROPERTIES INTERFACE_LINK_LIBRARIES "MPI::MPI_C;z;m;${CMAKE_DL_LIBS}")
  endif()
endif()
