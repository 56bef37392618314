# SPDX-License-Identifier: GPL-3.0-or-later
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pamr)
install(TARGETS pamr pamr_base pamr_geometry EXPORT pamr FILE_SET HEADERS)
install(EXPORT pamr NAMESPACE pamr:: DESTINATION ${config_dir} FILE pamrTargets.cmake)
configure_package_config_file(cmake/pamrConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/pamrConfig.cmake
  INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/pamrConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pamrConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/pamrConfigVersion.cmake
  cmake/FindParallelHDF5.cmake cmake/FindPTScotch.cmake DESTINATION ${config_dir})
