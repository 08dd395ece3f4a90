# SPDX-License-Identifier: Apache-2.0
# aussois_library(<folder> SOURCES ... HEADERS ... USES ... HEAVY ...): the library of one folder.
# USES are seen by users of the folder; HEAVY ones stay inside its .cpp files. Of the heavy ones, users of an
# installed static library must find those that are libraries again (aussois_install.cmake), not those of headers only.
set(AUSSOIS_HEADER_ONLY CGAL Boost nlohmann_json CLI11)

function(aussois_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;HEADERS;USES;HEAVY" ${ARGN})
  add_library(aussois_${name})
  add_library(aussois::${name} ALIAS aussois_${name})
  foreach(header IN LISTS arg_HEADERS)   # its own source includes it first (rule own_header_first): it compiles alone
    string(REGEX REPLACE "hpp$" "cpp" source ${header})
    if(source IN_LIST arg_SOURCES)
      list(APPEND with_source ${header})
    else()
      list(APPEND without_source ${header})
    endif()
  endforeach()
  set_target_properties(aussois_${name} PROPERTIES EXPORT_NAME ${name}
    VERIFY_INTERFACE_HEADER_SETS ON INTERFACE_HEADER_SETS_TO_VERIFY without_source
    POSITION_INDEPENDENT_CODE ON VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_sources(aussois_${name} PRIVATE ${arg_SOURCES}
    PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${with_source}
           FILE_SET without_source TYPE HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${without_source})
  target_link_libraries(aussois_${name} PUBLIC aussois_options Eigen3::Eigen ${arg_USES}
    PRIVATE $<BUILD_INTERFACE:aussois_warnings>)
  aussois_batches(aussois_${name} room)
  foreach(library IN LISTS arg_HEAVY)
    string(REGEX REPLACE "::.*" "" package ${library})
    if(package IN_LIST AUSSOIS_HEADER_ONLY)
      target_link_libraries(aussois_${name} PRIVATE $<BUILD_INTERFACE:${library}>)
      if(package STREQUAL "CGAL")   # no GPL parts of it (doc/decisions/0008); its headers call these two libraries
        target_compile_definitions(aussois_${name} PRIVATE CGAL_LICENSE_ERROR)
        target_link_libraries(aussois_${name} PRIVATE $<INSTALL_INTERFACE:gmp> $<INSTALL_INTERFACE:mpfr>)
      endif()
    else()
      target_link_libraries(aussois_${name} PRIVATE ${library})
    endif()
  endforeach()
  set_property(GLOBAL APPEND PROPERTY AUSSOIS_LIBRARIES ${name})
  set_property(GLOBAL PROPERTY AUSSOIS_HEAVY_${name} ${arg_HEAVY})
endfunction()
