# Configures, builds and runs consumer/ against abbe. WAY is find_package or add_subdirectory.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nfailed with ${result}:\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${SCRATCH_DIR})
set(options -D CONSUMER_WAY=${WAY} -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_COMPILER=${COMPILER}
  -D CMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER})
if(WAY STREQUAL find_package)
  run(${CMAKE_COMMAND} --install ${ABBE_BINARY_DIR} --prefix ${SCRATCH_DIR}/prefix)
  list(APPEND options -D CMAKE_PREFIX_PATH=${SCRATCH_DIR}/prefix)
  if(SANITIZE)
    list(APPEND options -D CMAKE_CXX_FLAGS=-fsanitize=${SANITIZE})
  endif()
else()
  list(APPEND options -D CONSUMER_ABBE_DIR=${ABBE_SOURCE_DIR})
endif()
run(${CMAKE_COMMAND} -G Ninja -S ${CONSUMER_SOURCE_DIR} -B ${SCRATCH_DIR}/build ${options})
run(${CMAKE_COMMAND} --build ${SCRATCH_DIR}/build --target consumer)
run(${SCRATCH_DIR}/build/consumer)

# The installed program finds its data beside itself, wherever the prefix lies.
if(WAY STREQUAL find_package AND EXISTS ${SCRATCH_DIR}/prefix/bin/abbe)
  run(${SCRATCH_DIR}/prefix/bin/abbe inspect
    ${SCRATCH_DIR}/prefix/share/abbe/scenes/prism/prism.gltf)
endif()
