# SPDX-License-Identifier: GPL-3.0-or-later
# Which MPI the compiler uses, as PAMR_MPI_FAMILY: openmpi, mpich (and all that share its interface), or empty where that is not known.
# Libraries that speak MPI have to belong to the same one: with another they link and crash, or do not link.
set(PAMR_MPI_FAMILY "")
foreach(folder IN LISTS MPI_CXX_INCLUDE_DIRS MPI_C_INCLUDE_DIRS)
  if(NOT PAMR_MPI_FAMILY AND EXISTS ${folder}/mpi.h)
    file(STRINGS ${folder}/mpi.h of_mpi REGEX "define +(OMPI_MAJOR_VERSION|MPICH_VERSION)")
    if(of_mpi MATCHES OMPI)
      set(PAMR_MPI_FAMILY openmpi)
    elseif(of_mpi)
      set(PAMR_MPI_FAMILY mpich)
    endif()
  endif()
endforeach()

# pamr_is_of_this_mpi(library result): false for a library that was built for the other one. Open MPI's handles have names of their own.
function(pamr_is_of_this_mpi library result)
  set(${result} TRUE PARENT_SCOPE)
  if(PAMR_MPI_FAMILY AND library AND EXISTS ${library})
    file(STRINGS ${library} handles REGEX "ompi_mpi_" LIMIT_COUNT 1)
    if((handles AND PAMR_MPI_FAMILY STREQUAL mpich) OR (NOT handles AND PAMR_MPI_FAMILY STREQUAL openmpi))
      set(${result} FALSE PARENT_SCOPE)
    endif()
  endif()
endfunction()
