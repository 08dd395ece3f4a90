# SPDX-License-Identifier: Apache-2.0
# aussois_test(<name> LABEL <label> [SLOW <regex>] [LONG <regex>] [SERIAL <regex>] SOURCES ... USES ...): one GoogleTest
# executable, its tests discovered; those whose names match SLOW take over ten seconds in release and have the label slow too, those
# that match LONG many minutes, and both labels: they are disabled unless AUSSOIS_LONG_TESTS is on. Those that match
# SERIAL run alone, since they measure time.
# Tests read AUSSOIS_DATA_DIR from the environment (empty: skip). Sources that read small inputs of the project are
# given AUSSOIS_SOURCE_DIR one by one: the others compile to the same in every checkout.
include(GoogleTest)
function(aussois_test name)
  cmake_parse_arguments(arg "" "LABEL;SLOW;LONG;SERIAL;TIMEOUT" "SOURCES;USES" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if(AUSSOIS_SANITIZE)   # some ten times slower
    math(EXPR arg_TIMEOUT "10 * ${arg_TIMEOUT}")
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  aussois_batches(${name} test)
  target_link_libraries(${name} PRIVATE ${arg_USES} aussois_warnings GTest::gtest_main)
  gtest_discover_tests(${name} TEST_PREFIX "${arg_LABEL}." TEST_LIST ${name}_tests DISCOVERY_TIMEOUT 60
    NO_PRETTY_VALUES   # the value of a struct is its bytes: hundreds of columns, and other ones in every build
    PROPERTIES LABELS "${arg_LABEL}" TIMEOUT ${arg_TIMEOUT} ENVIRONMENT "AUSSOIS_DATA_DIR=${AUSSOIS_DATA_DIR}")
  set(slow "LABELS \"${arg_LABEL};slow\"")
  set(long "LABELS \"${arg_LABEL};slow;long\" TIMEOUT 14400")
  if(NOT AUSSOIS_LONG_TESTS)
    string(APPEND long " DISABLED ON")
  endif()
  set(serial "RUN_SERIAL ON")
  foreach(weight IN ITEMS slow long serial)   # read by ctest: discovery takes no list of labels
    string(TOUPPER ${weight} regex)
    if(arg_${regex})
      set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}_${weight}.cmake)
      file(WRITE ${file} "set(matching \${${name}_tests})\nlist(FILTER matching INCLUDE REGEX [==[${arg_${regex}}]==])\n"
        "if(matching)\n  set_tests_properties(\${matching} PROPERTIES ${${weight}})\n"
        "elseif(${name}_tests)\n  message(WARNING \"${name}: no test matches ${regex} ${arg_${regex}}\")\nendif()\n")
      set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${file})
    endif()
  endforeach()
endfunction()
