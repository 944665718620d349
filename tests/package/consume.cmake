# Configures, builds and runs consumer/ against abbe. WAY is find_package or add_subdirectory.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nfailed with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH_DIR})
set(options -D CONSUMER_WAY=${WAY} -D CMAKE_BUILD_TYPE=${BUILD_TYPE}
  -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
if(WAY STREQUAL find_package)
  run(${CMAKE_COMMAND} --install ${ABBE_BINARY_DIR} --prefix ${SCRATCH_DIR}/prefix)
  # A consumer writes "abbe/…", and meets nothing else of ours.
  file(GLOB headers RELATIVE ${SCRATCH_DIR}/prefix/include ${SCRATCH_DIR}/prefix/include/*)
  if(NOT headers STREQUAL abbe)
    message(FATAL_ERROR "include/ holds ${headers}, expected abbe alone")
  endif()
  list(APPEND options -D CMAKE_PREFIX_PATH=${SCRATCH_DIR}/prefix)
  if(SANITIZE)
    list(APPEND options -D CMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
  endif()
  set(ENV{ABBE_SPECTRA_PATH} ${SCRATCH_DIR}/prefix/share/abbe/spectra)
else()
  list(APPEND options -D CONSUMER_ABBE_DIR=${ABBE_SOURCE_DIR}
    -D ABBE_WARNINGS_AS_ERRORS=${WARNINGS_AS_ERRORS})
endif()
run(${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_SOURCE_DIR} -B ${SCRATCH_DIR}/build ${options})
run(${CMAKE_COMMAND} --build ${SCRATCH_DIR}/build --target consumer)

# A crop with its pixels and its spectrum, and a whole file.
run(${SCRATCH_DIR}/build/consumer ${ABBE_SOURCE_DIR}/scenes/prism/prism.gltf
  ${SCRATCH_DIR}/crop.exr)
foreach(channel IN ITEMS R G B S0.410,000000nm S0.690,000000nm)
  if(NOT output MATCHES "(^|\n)${channel} +[0-9]")
    message(FATAL_ERROR "no channel ${channel} in what the consumer says:\n${output}")
  endif()
endforeach()
if(NOT EXISTS ${SCRATCH_DIR}/crop.exr)
  message(FATAL_ERROR "the consumer has written no EXR")
endif()

# The installed program finds its data beside itself, wherever the prefix lies.
unset(ENV{ABBE_SPECTRA_PATH})
if(WAY STREQUAL find_package AND EXISTS ${SCRATCH_DIR}/prefix/bin/abbe)
  run(${SCRATCH_DIR}/prefix/bin/abbe inspect
    ${SCRATCH_DIR}/prefix/share/abbe/scenes/prism/prism.gltf)
  run(${SCRATCH_DIR}/prefix/bin/abbe inspect ${SCRATCH_DIR}/crop.exr)
  if(NOT output MATCHES "--size 160x90 --crop 60,20,100,70")
    message(FATAL_ERROR "the consumer's file does not say how it was made:\n${output}")
  endif()
  # So it does with what reads and writes JPEG, which is loaded when first needed.
  run(${SCRATCH_DIR}/prefix/bin/abbe display ${SCRATCH_DIR}/crop.exr -o ${SCRATCH_DIR}/crop.jpg)
endif()
