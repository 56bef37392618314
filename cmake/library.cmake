# SPDX-License-Identifier: GPL-3.0-or-later
# pamr_add_library(target name): one of the libraries that are installed, as pamr::<name>. It is static, or shared where
# BUILD_SHARED_LIBS is on.

# Before 1.0.0 a minor version may break interfaces (docs/packages.md): the name that the loader looks for changes with it, and
# find_package takes no other.
set(PAMR_SOVERSION ${PROJECT_VERSION_MAJOR})
set(PAMR_COMPATIBILITY SameMajorVersion)
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(PAMR_SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set(PAMR_COMPATIBILITY SameMinorVersion)
endif()

function(pamr_add_library target name)
  add_library(${target})
  add_library(pamr::${name} ALIAS ${target})
  # No macro says that a library is compiled: objects of static and shared ones are the same, so that one build folder can be
  # turned from one into the other by linking again.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} DEFINE_SYMBOL "" VERSION ${PROJECT_VERSION}
    SOVERSION ${PAMR_SOVERSION})
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL SHARED_LIBRARY)
    return()
  endif()
  # The others are beside it, what it loads while it runs is in a folder below.
  cmake_path(GET PAMR_MODULE_DIR FILENAME modules)
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN;$ORIGIN/${modules}"
    LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/exported_names.map)
  target_link_options(${target} PRIVATE LINKER:--version-script=${PROJECT_SOURCE_DIR}/cmake/exported_names.map)
  if(NOT PAMR_SANITIZE) # whose functions are in the program
    target_link_options(${target} PRIVATE LINKER:--no-undefined)
  endif()
endfunction()
