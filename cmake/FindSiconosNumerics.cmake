# SPDX-License-Identifier: Apache-2.0
# Siconos::siconos_numerics, the solvers of Siconos [Acary2019]. Debian's CMake file of it asks for the whole of Siconos.
find_path(SiconosNumerics_INCLUDE_DIR siconos/numerics/NonSmoothDrivers.h)
find_library(SiconosNumerics_LIBRARY siconos_numerics)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SiconosNumerics REQUIRED_VARS SiconosNumerics_LIBRARY SiconosNumerics_INCLUDE_DIR)
if(SiconosNumerics_FOUND AND NOT TARGET Siconos::siconos_numerics)
  add_library(Siconos::siconos_numerics UNKNOWN IMPORTED)
  set_target_properties(Siconos::siconos_numerics PROPERTIES IMPORTED_LOCATION "${SiconosNumerics_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES
    "${SiconosNumerics_INCLUDE_DIR}/siconos;${SiconosNumerics_INCLUDE_DIR}/siconos/numerics")
endif()
mark_as_advanced(SiconosNumerics_INCLUDE_DIR SiconosNumerics_LIBRARY)
