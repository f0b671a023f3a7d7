# Turns on the warnings that this project must compile without. They are errors in the preset `dev` only
# (CMAKE_COMPILE_WARNING_AS_ERROR), so that a new compiler never breaks a user's build.
#
# GCC 12 mistakes some string concatenations for overlapping copies (-Wrestrict) and moves of fixed-size Eigen matrices
# for reads of uninitialised memory. Clang sees that libstdc++ 12 sorts by a function that it deprecates.
function(csrbf_set_warnings target)
  target_compile_options(
    ${target}
    PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:
            -Wall
            -Wextra
            -Wshadow
            -Wconversion
            -Wno-sign-conversion
            -Wnon-virtual-dtor
            -Woverloaded-virtual
            -Wcast-align
            -Wold-style-cast
            -Wimplicit-fallthrough>
            $<$<CXX_COMPILER_ID:GNU>:
            -Wduplicated-cond
            -Wlogical-op
            -Wno-restrict
            -Wno-error=maybe-uninitialized>
            $<$<CXX_COMPILER_ID:Clang>:-Wno-error=deprecated-declarations>)
endfunction()
