# SPDX-License-Identifier: Apache-2.0
# CVODE of SUNDIALS with its serial vectors and dense matrices: target CVODE::CVODE. Not SUNDIALS' own
# configuration, which asks for MPI and PETSc where it was built with them.
find_path(CVODE_INCLUDE_DIR cvode/cvode.h)
set(CVODE_LIBRARIES "")
foreach(library IN ITEMS cvode nvecserial sunmatrixdense sunlinsoldense sunnonlinsolfixedpoint)
  find_library(CVODE_${library}_LIBRARY sundials_${library})
  mark_as_advanced(CVODE_${library}_LIBRARY)
  list(APPEND CVODE_LIBRARIES ${CVODE_${library}_LIBRARY})
endforeach()
if(CVODE_INCLUDE_DIR)
  file(STRINGS ${CVODE_INCLUDE_DIR}/sundials/sundials_config.h line REGEX "define SUNDIALS_VERSION ")
  string(REGEX REPLACE ".*\"([0-9.]+).*" "\\1" CVODE_SUNDIALS_VERSION "${line}")
endif()
mark_as_advanced(CVODE_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(CVODE REQUIRED_VARS CVODE_cvode_LIBRARY CVODE_nvecserial_LIBRARY CVODE_INCLUDE_DIR
  VERSION_VAR CVODE_SUNDIALS_VERSION)
if(CVODE_FOUND AND NOT TARGET CVODE::CVODE)
  add_library(CVODE::CVODE INTERFACE IMPORTED)
  target_include_directories(CVODE::CVODE INTERFACE ${CVODE_INCLUDE_DIR})
  target_link_libraries(CVODE::CVODE INTERFACE ${CVODE_LIBRARIES})
endif()
