# Fails when a file of the project breaks a rule that no compiler checks.
# usage: cmake -D SOURCE_DIR=... -P files.cmake
cmake_minimum_required(VERSION 3.25)

set(longest 400)
set(fullest 30)  # code files in a folder
set(code "\\.(hpp|cpp|js)$")

# Nothing says on which machine, where or when the project was written.
set(foreign "/(work|home|root|tmp)/" "(deb\\.debian|registry\\.npmjs|pypi)\\.org" "(this|last|next|previous|earlier) session"
    "[Hh]elper [A-Z][^a-z]")

set(violations "")
foreach(folder IN ITEMS src app tests cmake examples benchmarks python viewer wasm docs scripts)
  file(GLOB_RECURSE found RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${folder}/*.hpp ${SOURCE_DIR}/${folder}/*.cpp
       ${SOURCE_DIR}/${folder}/*.in ${SOURCE_DIR}/${folder}/*.cmake ${SOURCE_DIR}/${folder}/*.txt
       ${SOURCE_DIR}/${folder}/*.sh ${SOURCE_DIR}/${folder}/*.py ${SOURCE_DIR}/${folder}/*.js ${SOURCE_DIR}/${folder}/*.md)
  list(FILTER found EXCLUDE REGEX "/node_modules/")
  list(APPEND files ${found})
endforeach()
file(GLOB found RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/*.md ${SOURCE_DIR}/*.txt ${SOURCE_DIR}/*.json ${SOURCE_DIR}/check
     ${SOURCE_DIR}/quickstart)
list(APPEND files ${found})

foreach(file IN LISTS files)
  file(READ ${SOURCE_DIR}/${file} text)
  if(text MATCHES "\t")
    string(APPEND violations "\n  ${file}: has a tab; indent with spaces")
  endif()
  if(text MATCHES "[ \t\r]\n")
    string(APPEND violations "\n  ${file}: has white space at the end of a line")
  endif()
  if(NOT text MATCHES "[^\n]\n$")
    string(APPEND violations "\n  ${file}: does not end with exactly one newline")
  endif()
  foreach(pattern IN LISTS foreign)
    if(text MATCHES "(${pattern})")
      string(APPEND violations "\n  ${file}: \"${CMAKE_MATCH_1}\" names a place outside the project")
    endif()
  endforeach()
  if(file MATCHES "${code}")
    string(REGEX MATCHALL "\n" newlines "${text}")
    list(LENGTH newlines lines)
    if(lines GREATER longest)
      string(APPEND violations "\n  ${file}: has ${lines} lines, more than ${longest}; split it by what it does")
    endif()
    cmake_path(GET file PARENT_PATH folder)
    set_property(GLOBAL APPEND PROPERTY in_${folder} ${file})
    set_property(GLOBAL APPEND PROPERTY folders ${folder})
    if(NOT file MATCHES "(^|/)[a-z0-9_]+\\.(hpp|cpp|js|test\\.js)$")
      string(APPEND violations "\n  ${file}: name files in snake_case")
    endif()
    if(file MATCHES "\\.hpp$" AND NOT text MATCHES "^#pragma once\n")
      string(APPEND violations "\n  ${file}: start headers with #pragma once")
    endif()
  endif()
endforeach()

get_property(folders GLOBAL PROPERTY folders)
list(REMOVE_DUPLICATES folders)
foreach(folder IN LISTS folders)
  get_property(inside GLOBAL PROPERTY in_${folder})
  list(LENGTH inside count)
  if(count GREATER fullest AND NOT folder STREQUAL "examples/thesis")
    string(APPEND violations "\n  ${folder}: holds ${count} files of code, more than ${fullest}; sort them into rooms")
  endif()
endforeach()

list(LENGTH files count)
if(violations)
  message(FATAL_ERROR "Files that break the rules:${violations}")
endif()
message(STATUS "${count} files keep the rules")
