# OpenColorIO by pkg-config: Debian 12 puts its CMake config where CMake does not look, with an
# include path that does not exist. Defines OpenColorIO::OpenColorIO.
find_package(PkgConfig QUIET REQUIRED)
pkg_check_modules(PC_OpenColorIO QUIET IMPORTED_TARGET OpenColorIO)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenColorIO
  REQUIRED_VARS PC_OpenColorIO_LINK_LIBRARIES VERSION_VAR PC_OpenColorIO_VERSION)
if(OpenColorIO_FOUND AND NOT TARGET OpenColorIO::OpenColorIO)
  add_library(OpenColorIO::OpenColorIO INTERFACE IMPORTED)
  target_link_libraries(OpenColorIO::OpenColorIO INTERFACE PkgConfig::PC_OpenColorIO)
endif()
