# make install: the program, the libraries with their headers, the data they need at run time, and
# a CMake package, so that find_package(abbe) gives abbe::abbe and one target per module.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/abbe)
get_property(modules GLOBAL PROPERTY ABBE_MODULES)

install(TARGETS abbe abbe_baseline ${modules} EXPORT abbe-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
if(TARGET abbe_draco)
  install(FILES ${PROJECT_BINARY_DIR}/libabbe_draco.a DESTINATION ${CMAKE_INSTALL_LIBDIR})
endif()
install(TARGETS abbe_raster LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/abbe)
if(TARGET abbe_program)
  install(TARGETS abbe_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(DIRECTORY src/abbe DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING
  PATTERN "*.h"
  PATTERN "cli" EXCLUDE)
install(DIRECTORY spectra config scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/abbe)

install(EXPORT abbe-targets NAMESPACE abbe:: DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/abbe-config.cmake.in
  ${PROJECT_BINARY_DIR}/abbe-config.cmake INSTALL_DESTINATION ${package_folder}
  PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/abbe-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/abbe-config.cmake
  ${PROJECT_BINARY_DIR}/abbe-config-version.cmake
  ${CMAKE_CURRENT_LIST_DIR}/AbbeDependencies.cmake
  ${CMAKE_CURRENT_LIST_DIR}/FindOpenColorIO.cmake
  DESTINATION ${package_folder})
