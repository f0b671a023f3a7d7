# Cross compilation to WebAssembly by Debian's Emscripten. scripts/wasm_libraries makes the folder with the libraries, which
# the environment variable CSRBF_SYSROOT names. Programs run by node.
#
# Fixed-width SIMD and WebAssembly's own exceptions: Chrome 95, Firefox 100, Safari 16.4, node 17.
include(/usr/share/emscripten/cmake/Modules/Platform/Emscripten.cmake)
# Clang 14 turns some pairs of 64-bit masks into wrong vector code (polygonize then never ends), hence no SLP.
set(csrbf_wasm_flags "-msimd128 -fwasm-exceptions -sSUPPORT_LONGJMP=wasm -fno-slp-vectorize")
set(CMAKE_C_FLAGS_INIT "${csrbf_wasm_flags}")
set(CMAKE_CXX_FLAGS_INIT "${csrbf_wasm_flags}")
# Emscripten's scripts need the module acorn, which Debian installs where Debian's node alone looks.
set(CMAKE_C_LINKER_LAUNCHER ${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs:/usr/share/node_modules)
set(CMAKE_CXX_LINKER_LAUNCHER ${CMAKE_C_LINKER_LAUNCHER})
set(ENV{NODE_PATH} /usr/share/nodejs:/usr/share/node_modules)
set(CMAKE_FIND_ROOT_PATH $ENV{CSRBF_SYSROOT} $ENV{CSRBF_SYSROOT}/usr ${CMAKE_FIND_ROOT_PATH})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
