# SPDX-License-Identifier: Apache-2.0
# Installs the build tree BUILD below WORK, moves the installation, and builds and runs the consumer from there twice:
# found by find_package, and found by pkg-config.
cmake_minimum_required(VERSION 3.25)
separate_arguments(flag_list UNIX_COMMAND "${FLAGS}")

function(try)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "exit ${result}: ${command}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
try(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
file(RENAME ${WORK}/first ${WORK}/moved)

file(GLOB_RECURSE texts ${WORK}/moved/share/doc/*/doc/theory/lmd.md ${WORK}/moved/share/doc/*/examples/drivers/sliding_block.cpp)
list(LENGTH texts count)
if(NOT count EQUAL 2)
  message(FATAL_ERROR "the manual and the sources of the drivers must be installed, found: ${texts}")
endif()

message("-- by find_package")
try(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/moved
  -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS})
try(${CMAKE_COMMAND} --build ${WORK}/build)
try(${WORK}/build/consumer)

if(PKG_CONFIG)
  message("-- by pkg-config")
  set(ENV{PKG_CONFIG_PATH} ${WORK}/moved/${LIBDIR}/pkgconfig)
  execute_process(COMMAND ${PKG_CONFIG} --cflags --libs aussois OUTPUT_VARIABLE found COMMAND_ERROR_IS_FATAL ANY
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  separate_arguments(found UNIX_COMMAND "${found}")
  try(${COMPILER} ${flag_list} ${CMAKE_CURRENT_LIST_DIR}/consumer.cpp -o ${WORK}/by_pkg_config ${found})
  try(${WORK}/by_pkg_config)

  message("-- the program of README, unoptimised and optimised")
  foreach(level IN ITEMS -O0 -O3)
    try(${COMPILER} ${flag_list} ${level} ${CMAKE_CURRENT_LIST_DIR}/../../../examples/first/01_drop_a_ball.cpp
      -o ${WORK}/first${level} ${found})
    try(${WORK}/first${level})
  endforeach()
endif()

file(GLOB_RECURSE texts ${WORK}/moved/*.cmake ${WORK}/moved/*.pc)
foreach(text IN LISTS texts)
  file(READ ${text} content)
  string(FIND "${content}" ${BUILD} place)
  if(NOT place EQUAL -1)
    message(FATAL_ERROR "${text} names the build tree: it cannot be moved")
  endif()
endforeach()
