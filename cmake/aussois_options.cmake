# SPDX-License-Identifier: Apache-2.0
# The flags of every target: language, warnings, sanitizers, and the arithmetic that makes results repeatable.
add_library(aussois_options INTERFACE)
add_library(aussois::options ALIAS aussois_options)
set_target_properties(aussois_options PROPERTIES EXPORT_NAME options)
target_compile_features(aussois_options INTERFACE cxx_std_20)
target_compile_options(aussois_options INTERFACE -ffp-contract=off)   # same bits wherever a line is inlined
if(AUSSOIS_NATIVE)
  target_compile_options(aussois_options INTERFACE -march=native)     # seen by users too: Eigen's alignment is ABI
endif()

add_library(aussois_warnings INTERFACE)   # for our own sources only, never exported
# Indices are ints: -1 is nothing, and differences are signed. Clang would count each as a lost sign.
target_compile_options(aussois_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<BOOL:${AUSSOIS_WERROR}>:-Werror>)

if(AUSSOIS_SANITIZE)
  add_compile_options(-fsanitize=${AUSSOIS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)   # indices are checked
  add_link_options(-fsanitize=${AUSSOIS_SANITIZE})
endif()

if(PROJECT_IS_TOP_LEVEL AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
  find_program(AUSSOIS_CCACHE ccache DOC "compiler cache, used when present")
  mark_as_advanced(AUSSOIS_CCACHE)
  if(AUSSOIS_CCACHE)
    set(CMAKE_C_COMPILER_LAUNCHER ${AUSSOIS_CCACHE})
    # sloppiness: without it ccache keeps nothing that a precompiled header was read for
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${AUSSOIS_CCACHE})
  endif()
endif()
