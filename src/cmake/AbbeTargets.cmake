# How every target of the project is compiled, and the one way a module is declared.

if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# What all code that sees the project's headers must agree on, users of the library included:
# inline functions merge at link time, so one caller's flags would otherwise decide for all.
add_library(abbe_baseline INTERFACE)
add_library(abbe::baseline ALIAS abbe_baseline)
set_target_properties(abbe_baseline PROPERTIES EXPORT_NAME baseline)
target_compile_features(abbe_baseline INTERFACE cxx_std_20)
target_compile_options(abbe_baseline INTERFACE
  # The lowest processor: what Highway's SSE4 target needs, and nothing above it. Everything faster
  # is compiled per target inside -inl.h files and chosen at run time.
  -msse4.2 -maes -mpclmul
  # g++ would fuse a*b+c even across intrinsics; hits must be the same on every ISA level.
  -ffp-contract=off)

# Flags of the project's own code, tests included.
add_library(abbe_flags INTERFACE)
target_link_libraries(abbe_flags INTERFACE abbe_baseline)
target_compile_definitions(abbe_flags INTERFACE ABBE_VERSION="${PROJECT_VERSION}")
target_compile_options(abbe_flags INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  # g++ 12 sees overlaps in "literal" + std::string that are none (GCC bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  $<$<BOOL:${ABBE_WARNINGS_AS_ERRORS}>:-Werror>)
if(ABBE_SANITIZE)
  target_compile_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all
    # Both take longer than all else together where vector code is inlined: half an hour a file.
    $<$<CXX_COMPILER_ID:GNU>:-fno-sanitize-address-use-after-scope -fno-tree-pta>
    # The instrumented standard library looks uninitialised to g++.
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(abbe_flags INTERFACE -fsanitize=${ABBE_SANITIZE})
endif()

# abbe_module(NAME [DEPENDS modules of lower floors...] [LIBRARIES external targets its .cpp files use...]
#             [PUBLIC_LIBRARIES external targets seen through its headers...] [EXCLUDE folder of programs])
# One module of src/abbe/: all .cpp files of its folder and its parts, the folders in it; included as
# "abbe/NAME/file.h" or "abbe/NAME/PART/file.h".
function(abbe_module name)
  cmake_parse_arguments(arg "" "EXCLUDE" "DEPENDS;LIBRARIES;PUBLIC_LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  if(arg_EXCLUDE)
    list(FILTER sources EXCLUDE REGEX "/${arg_EXCLUDE}/[^/]*$")
  endif()
  list(TRANSFORM arg_DEPENDS PREPEND abbe_)
  if(sources)
    add_library(abbe_${name} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(abbe_${name} PRIVATE $<BUILD_INTERFACE:abbe_flags> ${arg_LIBRARIES})
  else()
    add_library(abbe_${name} INTERFACE)
    set(scope INTERFACE)
  endif()
  add_library(abbe::${name} ALIAS abbe_${name})
  set_target_properties(abbe_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(abbe_${name} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>)
  target_link_libraries(abbe_${name} ${scope} abbe_baseline ${arg_DEPENDS} ${arg_PUBLIC_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY ABBE_MODULES abbe_${name})
endfunction()
