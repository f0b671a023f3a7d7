# With CSRBF_THREAD_SANITIZER the library and the program are checked for data races. The tests themselves are not, so
# that their reference computations stay fast; the library is linked before them, because the linker takes the first of
# the inline functions that both contain. The preset uses clang: loops over small matrices are about three times as fast
# under its sanitizer as under that of gcc.
option(CSRBF_THREAD_SANITIZER "Check library and program for data races (preset tsan)" OFF)
if(CSRBF_THREAD_SANITIZER)
  foreach(target csrbf csrbf-program csrbf-cli)
    if(TARGET ${target})
      target_compile_options(${target} PRIVATE -fsanitize=thread -fno-omit-frame-pointer)
    endif()
  endforeach()
  target_link_options(
    csrbf INTERFACE $<BUILD_INTERFACE:-fsanitize=thread>
    $<BUILD_INTERFACE:LINKER:--whole-archive,$<TARGET_FILE:csrbf>,--no-whole-archive>)
endif()
