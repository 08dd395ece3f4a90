# SPDX-License-Identifier: Apache-2.0
# Install tree: headers in include/aussois/<folder>/, find_package(aussois), pkg-config, CPack.
include(CMakePackageConfigHelpers)

# What each heavy library is called by find_package, pkg-config and Debian. An unknown one stops the configuration here
# rather than a user's link somewhere else.
set(AUSSOIS_PACKAGE_TBB TBB tbb libtbb-dev)
set(AUSSOIS_PACKAGE_hdf5 HDF5 hdf5 libhdf5-dev)
set(AUSSOIS_PACKAGE_ZLIB ZLIB zlib zlib1g-dev)

get_property(libraries GLOBAL PROPERTY AUSSOIS_LIBRARIES)
set(AUSSOIS_FIND "")      # find_package names
set(AUSSOIS_DEBS libeigen3-dev)
foreach(unit IN ITEMS kernel io)   # one .pc file each
  set(${unit}_libs "")
  set(${unit}_requires "")
endforeach()
foreach(library IN LISTS libraries)
  set(unit kernel)
  if(library STREQUAL "io")
    set(unit io)
  endif()
  string(PREPEND ${unit}_libs " -laussois_${library}")   # users before the used
  get_property(heavy GLOBAL PROPERTY AUSSOIS_HEAVY_${library})
  list(FILTER heavy EXCLUDE REGEX "^\\$<BUILD_INTERFACE:")
  list(TRANSFORM heavy REPLACE "::.*" "")
  foreach(package IN LISTS heavy)
    if(package STREQUAL "CGAL")
      string(APPEND ${unit}_libs " -lmpfr -lgmp")
      list(APPEND AUSSOIS_DEBS libgmp-dev libmpfr-dev)
    elseif(package STREQUAL "KLU")   # has no .pc file
      string(APPEND ${unit}_libs " -lklu")
      list(APPEND AUSSOIS_FIND KLU)
      list(APPEND AUSSOIS_DEBS libsuitesparse-dev)
    elseif(package STREQUAL "meshoptimizer")   # nor has this one
      string(APPEND ${unit}_libs " -lmeshoptimizer")
      list(APPEND AUSSOIS_FIND meshoptimizer)
      list(APPEND AUSSOIS_DEBS libmeshoptimizer-dev)
    elseif(package STREQUAL "CVODE")   # nor has this one
      string(APPEND ${unit}_libs " -lsundials_cvode -lsundials_nvecserial")
      list(APPEND AUSSOIS_FIND CVODE)
      list(APPEND AUSSOIS_DEBS libsundials-dev)
    elseif(NOT package IN_LIST AUSSOIS_HEADER_ONLY)
      if(NOT DEFINED AUSSOIS_PACKAGE_${package})
        message(FATAL_ERROR "aussois_install.cmake: say how users find ${package}, which ${library} links")
      endif()
      list(GET AUSSOIS_PACKAGE_${package} 0 find)
      list(GET AUSSOIS_PACKAGE_${package} 1 pc)
      list(GET AUSSOIS_PACKAGE_${package} 2 deb)
      list(APPEND AUSSOIS_FIND ${find})
      list(APPEND ${unit}_requires ${pc})
      list(APPEND AUSSOIS_DEBS ${deb})
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES AUSSOIS_FIND)
list(REMOVE_DUPLICATES AUSSOIS_DEBS)

list(TRANSFORM libraries PREPEND aussois_ OUTPUT_VARIABLE targets)
install(TARGETS ${targets} aussois_options aussois_kernel EXPORT aussoisTargets
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/aussois
  FILE_SET without_source DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/aussois)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/aussois)
install(EXPORT aussoisTargets NAMESPACE aussois:: DESTINATION ${config_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/aussoisConfig.cmake.in
  ${PROJECT_BINARY_DIR}/aussoisConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/aussoisConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)   # while 0.x, a minor version may break its users
install(FILES ${PROJECT_BINARY_DIR}/aussoisConfig.cmake ${PROJECT_BINARY_DIR}/aussoisConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindCVODE.cmake
  ${PROJECT_SOURCE_DIR}/cmake/FindKLU.cmake DESTINATION ${config_dir})

# aussois.pc is the kernel, aussois-io.pc adds files; both find their prefix from where they lie.
file(RELATIVE_PATH AUSSOIS_PC_PREFIX /x/${CMAKE_INSTALL_LIBDIR}/pkgconfig /x)
foreach(unit IN ITEMS kernel io)
  set(PC_NAME aussois)
  set(PC_REQUIRES eigen3 ${kernel_requires})
  if(unit STREQUAL "io")
    set(PC_NAME aussois-io)
    set(PC_REQUIRES aussois ${io_requires})
  endif()
  set(PC_LIBS "${${unit}_libs}")
  list(REMOVE_DUPLICATES PC_REQUIRES)
  list(JOIN PC_REQUIRES " " PC_REQUIRES)
  if(PC_LIBS)
    configure_file(${PROJECT_SOURCE_DIR}/cmake/aussois.pc.in ${PROJECT_BINARY_DIR}/${PC_NAME}.pc @ONLY)
    install(FILES ${PROJECT_BINARY_DIR}/${PC_NAME}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  endif()
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/NOTICE ${PROJECT_SOURCE_DIR}/io/viewer/LICENSE.three.txt
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
# The manual and the drivers as they are written: pages link to each other, and to the sources of the drivers.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/doc/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/doc
  FILES_MATCHING PATTERN "*.md" PATTERN "*.bib" PATTERN "*.png" PATTERN "*.svg")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples
  FILES_MATCHING PATTERN "*.[ch]pp" PATTERN "*.md" PATTERN "*.obj" PATTERN "*.csv")

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB TGZ)
  set(CPACK_PACKAGE_NAME libaussois-dev)
  set(CPACK_PACKAGE_CONTACT "the Aussois developers")
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION libdevel)
  list(JOIN AUSSOIS_DEBS ", " CPACK_DEBIAN_PACKAGE_DEPENDS)
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_STRIP_FILES OFF)
  include(CPack)
endif()
