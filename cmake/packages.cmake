# SPDX-License-Identifier: GPL-3.0-or-later
# Parts of an installation beside the library, tools and Python package: man pages, completions, tutorials, and the manual if
# docs/build.sh has made it in the build folder. packaging/debian makes a package of each component.
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
if(PAMR_TOOLS)
  set(made ${PROJECT_BINARY_DIR}/made_of_help)
  install(CODE "execute_process(COMMAND \"${PROJECT_SOURCE_DIR}/scripts/man_pages.sh\" \"${PROJECT_BINARY_DIR}/bin\" \"${made}\"
    COMMAND_ERROR_IS_FATAL ANY)" COMPONENT tools)
  install(DIRECTORY ${made}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  install(DIRECTORY ${made}/completions/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT tools)
  install(DIRECTORY docs/tutorials DESTINATION ${CMAKE_INSTALL_DATADIR}/pamr COMPONENT tools USE_SOURCE_PERMISSIONS
    PATTERN pictures EXCLUDE PATTERN __pycache__ EXCLUDE)
endif()
install(FILES scripts/mpi_environment.sh DESTINATION ${CMAKE_INSTALL_DATADIR}/pamr COMPONENT tools)
install(DIRECTORY ${PROJECT_BINARY_DIR}/manual/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/pamr/html COMPONENT doc OPTIONAL
  PATTERN .doctrees EXCLUDE)

# Everything that is installed, without tests and benchmarks.
add_custom_target(installed)
foreach(target IN ITEMS pamr pamr_base pamr_cad pamr_geometry pamr_meshing pamr_dsmc pamr_poisson_boltzmann pamr_python pamr-convert
    pamr-diff pamr-dsmc pamr-mark pamr-mesh pamr-partition pamr-pb pamr-quality pamr-refine pamr-surface)
  if(TARGET ${target})
    add_dependencies(installed ${target})
  endif()
endforeach()
