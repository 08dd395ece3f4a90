# SPDX-License-Identifier: Apache-2.0
# aussois_test(<name> LABEL <label> [SLOW <regex>] SOURCES ... USES ...): one GoogleTest executable, its tests discovered;
# those whose names match the expression take over ten seconds in release and have the label slow too.
# Tests read AUSSOIS_DATA_DIR from the environment (empty: skip). Sources that read small inputs of the project are
# given AUSSOIS_SOURCE_DIR one by one: the others compile to the same in every checkout.
include(GoogleTest)
function(aussois_test name)
  cmake_parse_arguments(arg "" "LABEL;SLOW;TIMEOUT" "SOURCES;USES" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${arg_USES} aussois_warnings GTest::gtest_main)
  gtest_discover_tests(${name} TEST_PREFIX "${arg_LABEL}." TEST_LIST ${name}_tests DISCOVERY_TIMEOUT 60
    NO_PRETTY_VALUES   # the value of a struct is its bytes: hundreds of columns, and other ones in every build
    PROPERTIES LABELS "${arg_LABEL}" TIMEOUT ${arg_TIMEOUT} ENVIRONMENT "AUSSOIS_DATA_DIR=${AUSSOIS_DATA_DIR}")
  if(arg_SLOW)   # read by ctest: discovery takes no list of labels
    set(labels ${CMAKE_CURRENT_BINARY_DIR}/${name}_slow.cmake)
    file(WRITE ${labels} "list(FILTER ${name}_tests INCLUDE REGEX [==[${arg_SLOW}]==])\n"
      "set_tests_properties(\${${name}_tests} PROPERTIES LABELS \"${arg_LABEL};slow\")\n")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${labels})
  endif()
endfunction()
