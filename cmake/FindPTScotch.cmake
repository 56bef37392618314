# SPDX-License-Identifier: GPL-3.0-or-later
# PT-Scotch with 64-bit integers, static, as target `PTScotch::ptscotch`. Static, because all of Debian's shared builds
# (32 and 64 bits) bear the same name, so that the loader may take the wrong one. Scotch's own error printer is left
# out: pamr gives its own. For an installation elsewhere set PTScotch_ROOT.
set(suffixes scotch-int64)
find_path(PTScotch_INCLUDE_DIR ptscotch.h PATH_SUFFIXES ${suffixes})
find_library(PTScotch_LIBRARY NAMES libptscotch.a PATH_SUFFIXES ${suffixes})
find_library(PTScotch_SCOTCH_LIBRARY NAMES libscotch.a PATH_SUFFIXES ${suffixes})
find_library(PTScotch_Z_LIBRARY NAMES z)
find_library(PTScotch_BZ2_LIBRARY NAMES bz2)
find_library(PTScotch_LZMA_LIBRARY NAMES lzma)
if(PTScotch_INCLUDE_DIR)
  file(STRINGS ${PTScotch_INCLUDE_DIR}/scotch.h PTScotch_WITH_64_BITS REGEX "^typedef int64_t SCOTCH_Num;")
  file(STRINGS ${PTScotch_INCLUDE_DIR}/scotch.h version REGEX "^#define SCOTCH_(VERSION|RELEASE|PATCHLEVEL) ")
  list(TRANSFORM version REPLACE "[^0-9]+" "")
  list(JOIN version "." PTScotch_VERSION)
endif()
include(${CMAKE_CURRENT_LIST_DIR}/mpi_family.cmake)
pamr_is_of_this_mpi("${PTScotch_LIBRARY}" PTScotch_OF_THIS_MPI)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PTScotch
  REQUIRED_VARS PTScotch_LIBRARY PTScotch_SCOTCH_LIBRARY PTScotch_INCLUDE_DIR PTScotch_WITH_64_BITS PTScotch_OF_THIS_MPI
    PTScotch_Z_LIBRARY PTScotch_BZ2_LIBRARY PTScotch_LZMA_LIBRARY
  VERSION_VAR PTScotch_VERSION
  REASON_FAILURE_MESSAGE
    "PAMR needs the static PT-Scotch with 64-bit integers (Debian: libptscotch-dev libscotch-dev liblzma-dev libbz2-dev)")
mark_as_advanced(PTScotch_INCLUDE_DIR PTScotch_LIBRARY PTScotch_SCOTCH_LIBRARY PTScotch_Z_LIBRARY PTScotch_BZ2_LIBRARY
  PTScotch_LZMA_LIBRARY)
if(PTScotch_FOUND AND NOT TARGET PTScotch::ptscotch)
  find_package(Threads REQUIRED)
  add_library(PTScotch::ptscotch INTERFACE IMPORTED)
  set_target_properties(PTScotch::ptscotch PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${PTScotch_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${PTScotch_LIBRARY};${PTScotch_SCOTCH_LIBRARY};${PTScotch_Z_LIBRARY};${PTScotch_BZ2_LIBRARY};${PTScotch_LZMA_LIBRARY};m;Threads::Threads;MPI::MPI_CXX"
    # Programs may also load a shared 32-bit Scotch (PETSc does): it must not find these symbols.
    INTERFACE_LINK_OPTIONS "LINKER:--exclude-libs,libptscotch.a:libscotch.a")
endif()
