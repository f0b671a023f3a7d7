# With CSRBF_COVERAGE the library and the program count which lines run; the target `coverage` prints the share of those
# that did. The tests themselves are not counted. Threads may lose each other's counts: some are too small, and gcovr is
# told to ignore inconsistent ones.
option(CSRBF_COVERAGE "Count the lines that the tests run (preset coverage)" OFF)
if(CSRBF_COVERAGE)
  foreach(target csrbf csrbf-program csrbf-cli)
    if(TARGET ${target})
      target_compile_options(${target} PRIVATE -O1 --coverage -fprofile-update=single)
    endif()
  endforeach()
  target_link_options(csrbf PUBLIC $<BUILD_INTERFACE:--coverage>)

  find_program(GCOVR gcovr)
  mark_as_advanced(GCOVR)
  if(GCOVR)
    add_custom_target(
      coverage
      COMMAND ${GCOVR} --root ${PROJECT_SOURCE_DIR} --object-directory ${PROJECT_BINARY_DIR} --filter
              ${PROJECT_SOURCE_DIR}/src/ --filter ${PROJECT_SOURCE_DIR}/app/ --exclude-throw-branches
              --exclude-unreachable-branches --gcov-ignore-parse-errors
      USES_TERMINAL)
  else()
    add_custom_target(
      coverage
      COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/coverage.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}
      USES_TERMINAL)
  endif()
endif()
