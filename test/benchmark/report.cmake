# SPDX-License-Identifier: BSD-3-Clause
# The program of `./run report`. catkin_lint wants every program installed whose target does not name a test.

find_package(nlohmann_json REQUIRED)
find_path(BULLET_INCLUDE_DIR BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h PATH_SUFFIXES bullet)
set(bullet_libraries)
foreach(library BulletSoftBody BulletDynamics BulletCollision LinearMath)
  find_library(${library}_LIBRARY ${library})
  list(APPEND bullet_libraries ${${library}_LIBRARY})
endforeach()

file(GLOB report_sources CONFIGURE_DEPENDS test/benchmark/*.cpp)
list(FILTER report_sources EXCLUDE REGEX "/(bullet_body|cut_picture|bench_[a-z]+)\\.cpp$")
add_executable(polyscalpel_test_report EXCLUDE_FROM_ALL ${report_sources})
set_target_properties(polyscalpel_test_report PROPERTIES OUTPUT_NAME polyscalpel_report
  RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
target_include_directories(polyscalpel_test_report PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
target_link_libraries(polyscalpel_test_report PRIVATE polyscalpel_test_support nlohmann_json::nlohmann_json)
string(STRIP "${CMAKE_BUILD_TYPE}: ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_RELEASE}" report_flags)
target_compile_definitions(polyscalpel_test_report PRIVATE POLYSCALPEL_REPORT_FLAGS="${report_flags}")
# Without Bullet the report says that its part was not measured.
if(BULLET_INCLUDE_DIR AND NOT "${bullet_libraries}" MATCHES NOTFOUND)
  target_sources(polyscalpel_test_report PRIVATE test/benchmark/bullet_body.cpp)
  target_include_directories(polyscalpel_test_report SYSTEM PRIVATE ${BULLET_INCLUDE_DIR})
  target_link_libraries(polyscalpel_test_report PRIVATE ${bullet_libraries})
  target_compile_definitions(polyscalpel_test_report PRIVATE POLYSCALPEL_HAS_BULLET)
  # What its own headers leave uninitialised is none of our business.
  set_source_files_properties(test/benchmark/bullet_body.cpp PROPERTIES COMPILE_OPTIONS -Wno-maybe-uninitialized)
endif()

if(POLYSCALPEL_BUILD_ROS)
  # The bag of the report's picture in rviz.
  add_executable(polyscalpel_test_cut_picture EXCLUDE_FROM_ALL test/benchmark/cut_picture.cpp
    test/benchmark/cut_bodies.cpp test/benchmark/timing.cpp)
  set_target_properties(polyscalpel_test_cut_picture PROPERTIES OUTPUT_NAME polyscalpel_cut_picture
    RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  target_include_directories(polyscalpel_test_cut_picture PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test ${catkin_INCLUDE_DIRS})
  target_link_libraries(polyscalpel_test_cut_picture PRIVATE polyscalpel_ros_bridge)
endif()
