# Target `coverage` of the preset of that name: prints the share of lines that the tests ran.
if(CMAKE_CXX_FLAGS MATCHES "--coverage")
  find_program(GCOVR gcovr)
  mark_as_advanced(GCOVR)
  if(GCOVR)
    add_custom_target(
      coverage
      COMMAND ${GCOVR} --root ${PROJECT_SOURCE_DIR} --object-directory ${PROJECT_BINARY_DIR} --filter
              ${PROJECT_SOURCE_DIR}/src/ --filter ${PROJECT_SOURCE_DIR}/app/ --exclude-throw-branches
              --exclude-unreachable-branches
      USES_TERMINAL)
  else()
    add_custom_target(
      coverage
      COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/coverage.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}
      USES_TERMINAL)
  endif()
endif()
