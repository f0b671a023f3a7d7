# Most of the time of a build goes into headers and into templates that many files instantiate: files of a folder are
# therefore compiled together, several in one translation unit. OFF where single files are edited and compiled again, and
# where every file must show that it includes what it uses.
option(CSRBF_UNITY_BUILD "Compile the files of a folder together, with precompiled headers" ON)

# With precompiled headers GCC 12 takes some sums of strings, and matrices of one number, for writes or reads beyond their
# end. Files compiled alone keep the warnings.
set(CSRBF_PRECOMPILED_OPTIONS $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow>)

# csrbf_compile_together(<target> <file>... [ALONE <file>...] [HEADERS <header>...]): compiles the files together, those
# of a folder in groups of at most eight, except the ones ALONE, whose names in anonymous namespaces others of the folder
# have too. The headers are compiled once, before. The test `unity_names` reads the groups from compiled_together.txt.
function(csrbf_compile_together target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "ALONE;HEADERS")
  set(most 8)
  set(folders "")
  foreach(file ${arg_UNPARSED_ARGUMENTS})
    if(file IN_LIST arg_ALONE OR NOT file MATCHES "\\.cpp$")
      continue()
    endif()
    cmake_path(GET file PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "in_${folder}" id)
    list(APPEND folders ${id})
    list(APPEND files_${id} ${file})
  endforeach()
  list(REMOVE_DUPLICATES folders)

  foreach(id ${folders})
    list(LENGTH files_${id} count)
    math(EXPR groups "(${count} + ${most} - 1) / ${most}")
    set(at 0)
    foreach(file ${files_${id}})
      math(EXPR group "${at} * ${groups} / ${count}")
      set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${id}_${group})
      file(APPEND ${PROJECT_BINARY_DIR}/compiled_together.txt "${target}/${id}_${group} ${CMAKE_CURRENT_SOURCE_DIR}/${file}\n")
      math(EXPR at "${at} + 1")
    endforeach()
  endforeach()
  if(CSRBF_UNITY_BUILD)
    target_precompile_headers(${target} PRIVATE ${arg_HEADERS})
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # A local name may be that of something in another file's anonymous namespace, whose types GCC takes for those of a
    # header.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-Wno-shadow>
                                             $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>
                                             ${CSRBF_PRECOMPILED_OPTIONS})
  endif()
endfunction()
file(WRITE ${PROJECT_BINARY_DIR}/compiled_together.txt "")
