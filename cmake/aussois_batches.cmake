# SPDX-License-Identifier: Apache-2.0
# aussois_batches(<target> <kind>): with AUSSOIS_BATCHES, the sources of the target are compiled six at a time, and the
# headers of other projects that most of them include are parsed once for all targets of a kind (doc/decisions/0023).
# Kinds are room, driver and test.
set(AUSSOIS_PARSED_ONCE <algorithm> <array> <cmath> <filesystem> <functional> <map> <memory> <numeric> <optional> <span>
  <sstream> <stdexcept> <string> <vector> <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <Eigen/SparseCore>)

function(aussois_batches target kind)
  if(NOT AUSSOIS_BATCHES)
    return()
  endif()
  set(parsed aussois_parsed_${kind})
  if(NOT TARGET ${parsed})
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/${parsed}.cpp CONTENT "// A library has a source; this one is there for its headers.\n")
    add_library(${parsed} OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/${parsed}.cpp)
    target_link_libraries(${parsed} PRIVATE aussois_options aussois_warnings Eigen3::Eigen)
    target_precompile_headers(${parsed} PRIVATE ${AUSSOIS_PARSED_ONCE})
    if(kind STREQUAL "room")
      set_target_properties(${parsed} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    elseif(kind STREQUAL "test")
      target_link_libraries(${parsed} PRIVATE GTest::gtest)
      target_precompile_headers(${parsed} PRIVATE <gtest/gtest.h>)
    endif()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 6)
  target_precompile_headers(${target} REUSE_FROM ${parsed})
endfunction()
