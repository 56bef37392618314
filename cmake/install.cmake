# SPDX-License-Identifier: GPL-3.0-or-later
# The library and its headers; tools and the Python package install themselves. Components are the packages of
# cmake/packages.cmake.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pamr)
install(TARGETS pamr pamr_base pamr_geometry EXPORT pamr FILE_SET HEADERS)
# Headers of the refiner's clients begin with their folder ("meshing/..."), which stands beside the refiner's modules.
foreach(client IN ITEMS meshing dsmc poisson_boltzmann)
  if(TARGET pamr_${client})
    set_target_properties(pamr_${client} PROPERTIES EXPORT_NAME ${client})
    install(TARGETS pamr_${client} EXPORT pamr FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pamr)
  endif()
endforeach()
if(TARGET pamr_petsc_headers)
  set_target_properties(pamr_petsc_headers PROPERTIES EXPORT_NAME petsc_headers)
  install(TARGETS pamr_petsc_headers EXPORT pamr)
endif()
if(TARGET pamr_cad)
  install(TARGETS pamr_cad LIBRARY DESTINATION ${PAMR_MODULE_DIR} COMPONENT tools)
endif()
if(TARGET pamr_dsmc)
  install(FILES lib/solvers/dsmc/gas/gases.toml DESTINATION ${CMAKE_INSTALL_DATADIR}/pamr/species COMPONENT tools)
endif()
install(DIRECTORY docs/examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pamr/examples)
install(DIRECTORY cases/moving-front DESTINATION ${CMAKE_INSTALL_DATADIR}/pamr/examples
  FILES_MATCHING PATTERN "*.?pp" PATTERN CMakeLists.txt)
install(EXPORT pamr NAMESPACE pamr:: DESTINATION ${config_dir} FILE pamrTargets.cmake)
configure_package_config_file(cmake/pamrConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/pamrConfig.cmake
  INSTALL_DESTINATION ${config_dir})
# For builds without CMake. MPI's own libraries are the compiler wrapper's business.
file(RELATIVE_PATH from_pkgconfig ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
set(scotch)
if(PTScotch_FOUND)
  set(scotch ${PTScotch_LIBRARY} ${PTScotch_SCOTCH_LIBRARY} ${PTScotch_BZ2_LIBRARY} ${PTScotch_LZMA_LIBRARY})
endif()
set(libraries ${ParallelHDF5_LIBRARY} ${scotch} ${ZLIB_LIBRARIES} -lmpfr -lgmp -lm -lpthread ${CMAKE_DL_LIBS}
  -Wl,--exclude-libs,libptscotch.a:libscotch.a "-Wl,-rpath,\${prefix}/${PAMR_MODULE_DIR}")
list(TRANSFORM libraries REPLACE "^dl$" "-ldl")
list(JOIN libraries " " libraries)
configure_file(cmake/pamr.pc.in ${CMAKE_CURRENT_BINARY_DIR}/pamr.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pamr.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/pamrConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pamrConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/pamrConfigVersion.cmake
  cmake/FindParallelHDF5.cmake cmake/FindPTScotch.cmake cmake/mpi_family.cmake DESTINATION ${config_dir})
