# Writes compile.js of the npm package, with the bytes of a module in it.
# usage: cmake -D MODULE=FILE -D INPUT=compile.js.in -D OUTPUT=compile.js -P wasm_compile.cmake
execute_process(COMMAND base64 --wrap=0 ${MODULE} OUTPUT_VARIABLE UNPACKER COMMAND_ERROR_IS_FATAL ANY)
configure_file(${INPUT} ${OUTPUT} @ONLY)
