# Fails when clang-format would change a file.
# usage: cmake -D SOURCE_DIR=... -D CLANG_FORMAT=... -P format.cmake
cmake_minimum_required(VERSION 3.25)

foreach(folder IN ITEMS src app tests examples benchmarks python)
  file(GLOB_RECURSE found ${SOURCE_DIR}/${folder}/*.hpp ${SOURCE_DIR}/${folder}/*.cpp)
  list(APPEND files ${found})
endforeach()

execute_process(COMMAND ${CLANG_FORMAT} --dry-run --Werror ${files} RESULT_VARIABLE result ERROR_VARIABLE errors)
if(NOT result EQUAL 0)
  string(REGEX MATCHALL "${SOURCE_DIR}/[^:\n]+" names "${errors}")
  list(REMOVE_DUPLICATES names)
  list(JOIN names "\n  " names)
  message(FATAL_ERROR "Run clang-format -i on\n  ${names}")
endif()
list(LENGTH files count)
message(STATUS "${count} files are formatted")
