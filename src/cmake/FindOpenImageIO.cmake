# OpenImageIO by pkg-config: Debian 12's CMake config demands the command line tools and then
# fails on an include folder of OpenCV. Defines OpenImageIO::OpenImageIO.
find_package(PkgConfig QUIET REQUIRED)
pkg_check_modules(PC_OpenImageIO QUIET IMPORTED_TARGET OpenImageIO)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO
  REQUIRED_VARS PC_OpenImageIO_LINK_LIBRARIES VERSION_VAR PC_OpenImageIO_VERSION)
if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
  add_library(OpenImageIO::OpenImageIO INTERFACE IMPORTED)
  target_link_libraries(OpenImageIO::OpenImageIO INTERFACE PkgConfig::PC_OpenImageIO)
endif()
