# SPDX-License-Identifier: BSD-3-Clause
# The program of `./run report`. catkin_lint wants every program installed whose target does not name a test.

find_package(nlohmann_json REQUIRED)
include(${CMAKE_CURRENT_LIST_DIR}/bullet.cmake)

file(GLOB report_sources CONFIGURE_DEPENDS test/benchmark/*.cpp)
list(FILTER report_sources EXCLUDE REGEX "/(bullet_body|cut_picture|stage_counts|bench_[a-z_]+)\\.cpp$")
add_executable(polyscalpel_test_report EXCLUDE_FROM_ALL ${report_sources})
set_target_properties(polyscalpel_test_report PROPERTIES OUTPUT_NAME polyscalpel_report
  RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
target_include_directories(polyscalpel_test_report PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
target_link_libraries(polyscalpel_test_report PRIVATE polyscalpel_test_support nlohmann_json::nlohmann_json)
string(STRIP "${CMAKE_BUILD_TYPE}: ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_RELEASE}" report_flags)
target_compile_definitions(polyscalpel_test_report PRIVATE POLYSCALPEL_REPORT_FLAGS="${report_flags}")
add_bullet(polyscalpel_test_report)

# What callgrind counts. Without valgrind's headers it says so.
add_executable(polyscalpel_test_stage_counts EXCLUDE_FROM_ALL test/benchmark/stage_counts.cpp test/benchmark/step_stages.cpp
  test/benchmark/step_bodies.cpp test/benchmark/cut_bodies.cpp test/benchmark/timing.cpp)
set_target_properties(polyscalpel_test_stage_counts PROPERTIES OUTPUT_NAME polyscalpel_stage_counts
  RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
target_include_directories(polyscalpel_test_stage_counts PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
target_link_libraries(polyscalpel_test_stage_counts PRIVATE polyscalpel_core)

if(POLYSCALPEL_BUILD_ROS)
  # The bag of the report's picture in rviz.
  add_executable(polyscalpel_test_cut_picture EXCLUDE_FROM_ALL test/benchmark/cut_picture.cpp
    test/benchmark/cut_bodies.cpp test/benchmark/timing.cpp)
  set_target_properties(polyscalpel_test_cut_picture PROPERTIES OUTPUT_NAME polyscalpel_cut_picture
    RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
  target_include_directories(polyscalpel_test_cut_picture PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test ${catkin_INCLUDE_DIRS})
  target_link_libraries(polyscalpel_test_cut_picture PRIVATE polyscalpel_ros_bridge)
endif()
