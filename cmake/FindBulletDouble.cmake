# SPDX-License-Identifier: Apache-2.0
# Bullet::dynamics, the rigid bodies of Bullet in double precision. CMake's own module and Bullet's configuration find the
# single one (Debian: libbullet-dev has both).
find_path(BulletDouble_INCLUDE_DIR btBulletDynamicsCommon.h PATH_SUFFIXES bullet)
set(BulletDouble_LIBRARIES "")
foreach(library IN ITEMS BulletDynamics BulletCollision LinearMath)
  find_library(BulletDouble_${library}_LIBRARY ${library}-float64)
  mark_as_advanced(BulletDouble_${library}_LIBRARY)
  list(APPEND BulletDouble_LIBRARIES ${BulletDouble_${library}_LIBRARY})
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(BulletDouble REQUIRED_VARS BulletDouble_BulletDynamics_LIBRARY
  BulletDouble_BulletCollision_LIBRARY BulletDouble_LinearMath_LIBRARY BulletDouble_INCLUDE_DIR)
if(BulletDouble_FOUND AND NOT TARGET Bullet::dynamics)
  add_library(Bullet::dynamics INTERFACE IMPORTED)
  target_include_directories(Bullet::dynamics SYSTEM INTERFACE ${BulletDouble_INCLUDE_DIR})
  target_compile_definitions(Bullet::dynamics INTERFACE BT_USE_DOUBLE_PRECISION)
  target_link_libraries(Bullet::dynamics INTERFACE ${BulletDouble_LIBRARIES})
endif()
mark_as_advanced(BulletDouble_INCLUDE_DIR)
