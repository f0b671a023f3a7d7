# GCC searches its memory for garbage each time that it has grown by about a third, from 128 MB on: a tenth of the time
# of files with many templates (benchmarks/BUILD.md). With more memory before the first search it finds less to do.
include_guard()
cmake_host_system_information(RESULT memory QUERY TOTAL_PHYSICAL_MEMORY)
cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
math(EXPR default "${memory} / (3 * ${cores})")
if(default GREATER 1000)
  set(default 1000)
endif()
set(CSRBF_COMPILER_MEMORY ${default} CACHE STRING "MB that each GCC may use before it collects garbage; 0: as GCC does")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CSRBF_COMPILER_MEMORY GREATER 128)
  math(EXPR kilobytes "${CSRBF_COMPILER_MEMORY} * 1000")
  add_compile_options(--param=ggc-min-heapsize=${kilobytes})
endif()
