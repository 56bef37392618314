# SPDX-License-Identifier: GPL-3.0-or-later
# What this build does not have, which the end of the configuration and --version of the tools name.

# pamr_left_out(what why): such as "pamr-pb" and "Debian: petsc-dev pkgconf".
function(pamr_left_out what why)
  set_property(GLOBAL APPEND PROPERTY PAMR_LEFT_OUT "${what} (${why})")
endfunction()

# One line, empty if nothing is left out.
function(pamr_all_left_out result)
  get_property(all GLOBAL PROPERTY PAMR_LEFT_OUT)
  list(JOIN all ", " all)
  set(${result} "${all}" PARENT_SCOPE)
endfunction()

# pamr-picture is there in any case and looks for its packages when it runs.
function(pamr_say_what_is_left_out)
  if(PAMR_TOOLS)
    execute_process(COMMAND ${PAMR_SYSTEM_PYTHON} -c "from importlib.util import find_spec as find
raise SystemExit(not all(map(find, ('vtkmodules', 'matplotlib', 'h5py'))))" RESULT_VARIABLE missing OUTPUT_QUIET ERROR_QUIET)
    if(missing)
      pamr_left_out("pictures of pamr-picture, until installed" "Debian: python3-vtk9 python3-matplotlib python3-h5py")
    endif()
  endif()
  pamr_all_left_out(all)
  if(all)
    message(STATUS "Left out: ${all}")
  else()
    message(STATUS "Nothing is left out")
  endif()
endfunction()
