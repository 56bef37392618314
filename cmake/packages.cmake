# SPDX-License-Identifier: GPL-3.0-or-later
# Debian packages by CPack, one for each component: scripts/package.sh makes them. Man pages, completions and the manual are
# installed if that script (or docs/build.sh) has made them in the build folder.
if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()
install(DIRECTORY ${PROJECT_BINARY_DIR}/packages/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools OPTIONAL)
install(DIRECTORY ${PROJECT_BINARY_DIR}/packages/completions/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  COMPONENT tools OPTIONAL)
install(DIRECTORY docs/tutorials DESTINATION ${CMAKE_INSTALL_DATADIR}/pamr COMPONENT tools USE_SOURCE_PERMISSIONS
  PATTERN pictures EXCLUDE PATTERN __pycache__ EXCLUDE)
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

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pamr)
set(CPACK_PACKAGE_VENDOR "PAMR")
set(CPACK_PACKAGE_CONTACT "The PAMR authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL tools dev python doc)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_THREADS 0)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME pamr)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS openmpi-bin)
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "python3-vtk9, python3-matplotlib, python3-h5py, python3-meshio, xvfb")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "pamr-doc, python3-pamr, libpamr-dev")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "Parallel adaptive refinement of tetrahedral meshes: tools
 Makes, marks, refines, coarsens, measures and converts meshes of tetrahedra on any number
 of processes; boundaries that are curved stay so. With a solver for rarefied gas and one
 for the Poisson-Boltzmann equation.")

# The static library wants the headers and libraries that pamrConfig.cmake looks for. The library that reads CAD files is in the
# package of the tools.
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpamr-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libopenmpi-dev, libhdf5-openmpi-dev, libptscotch-dev, libscotch-dev, libbz2-dev, \
liblzma-dev, zlib1g-dev, libcgal-dev, libfmt-dev, libpugixml-dev, libtomlplusplus-dev, nlohmann-json3-dev, pamr (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "cmake (>= 3.25), petsc-dev")
set(CPACK_COMPONENT_DEV_DESCRIPTION "Parallel adaptive refinement of tetrahedral meshes: C++ library
 Static libraries, headers, CMake's configuration and an example.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-pamr)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${PAMR_PYTHON_DEPENDS}, python3-numpy, python3-mpi4py, pamr (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Parallel adaptive refinement of tetrahedral meshes: Python
 The package pamr: meshes in arrays of numpy, refined in memory, under mpirun as well.")

set(CPACK_DEBIAN_DOC_PACKAGE_NAME pamr-doc)
set(CPACK_DEBIAN_DOC_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
set(CPACK_COMPONENT_DOC_DESCRIPTION "Parallel adaptive refinement of tetrahedral meshes: manual
 The manual as pages that are searched without a network: /usr/share/doc/pamr/html/index.html.")
include(CPack)
