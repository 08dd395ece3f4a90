# aussois_library(<folder> SOURCES ... HEADERS ... USES ... HEAVY ...): the library of one folder.
# USES are seen by users of the folder; HEAVY ones stay inside its .cpp files.
function(aussois_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;HEADERS;USES;HEAVY" ${ARGN})
  add_library(aussois_${name})
  add_library(aussois::${name} ALIAS aussois_${name})
  set_target_properties(aussois_${name} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON
    POSITION_INDEPENDENT_CODE ON VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_sources(aussois_${name} PRIVATE ${arg_SOURCES}
    PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${arg_HEADERS})
  target_link_libraries(aussois_${name} PUBLIC aussois_options Eigen3::Eigen ${arg_USES}
    PRIVATE $<BUILD_INTERFACE:aussois_warnings> ${arg_HEAVY})
  install(TARGETS aussois_${name} EXPORT aussoisTargets
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/aussois)
endfunction()
