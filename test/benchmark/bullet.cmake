# SPDX-License-Identifier: BSD-3-Clause
# add_bullet(<target>): gives a program Bullet's body to compare with. Without Bullet its rows say that they were not measured.

find_path(BULLET_INCLUDE_DIR BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h PATH_SUFFIXES bullet)
set(bullet_libraries)
foreach(library BulletSoftBody BulletDynamics BulletCollision LinearMath)
  find_library(${library}_LIBRARY ${library})
  list(APPEND bullet_libraries ${${library}_LIBRARY})
endforeach()

function(add_bullet target)
  if(BULLET_INCLUDE_DIR AND NOT "${bullet_libraries}" MATCHES NOTFOUND)
    target_sources(${target} PRIVATE test/benchmark/bullet_body.cpp)
    target_include_directories(${target} SYSTEM PRIVATE ${BULLET_INCLUDE_DIR})
    target_link_libraries(${target} PRIVATE ${bullet_libraries})
    target_compile_definitions(${target} PRIVATE POLYSCALPEL_HAS_BULLET)
    # What its own headers leave uninitialised is none of our business.
    set_source_files_properties(test/benchmark/bullet_body.cpp PROPERTIES COMPILE_OPTIONS -Wno-maybe-uninitialized)
  endif()
endfunction()
