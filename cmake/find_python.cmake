# Sets CSRBF_PYTHON_FOUND when the requirements of the Python module are met: an interpreter with its headers and numpy,
# and pybind11. Unless one is given (Python3_EXECUTABLE), the interpreter is the first of `python3` and the system's own
# that has numpy.
if(NOT Python3_EXECUTABLE)
  find_program(CSRBF_PYTHON3 NAMES python3)
  mark_as_advanced(CSRBF_PYTHON3)
  foreach(candidate ${CSRBF_PYTHON3} /usr/bin/python3)
    execute_process(COMMAND ${candidate} -c "import numpy" RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
    if(result EQUAL 0)
      set(Python3_EXECUTABLE ${candidate} CACHE FILEPATH "Interpreter that the Python module is built for")
      break()
    endif()
  endforeach()
endif()

set(CSRBF_PYTHON_FOUND OFF)
if(Python3_EXECUTABLE)
  find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module)
  if(Python3_FOUND)
    find_package(pybind11 2.10 QUIET)
    set(CSRBF_PYTHON_FOUND ${pybind11_FOUND})
  endif()
endif()

set(CSRBF_PYTHON_DIR lib/python3/site-packages CACHE STRING "Where the Python module goes, below the prefix")
mark_as_advanced(CSRBF_PYTHON_DIR)
