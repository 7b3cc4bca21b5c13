# SPDX-License-Identifier: BSD-3-Clause
# The program of `./run bench`. catkin_lint wants every program installed whose target does not name a test.

find_path(BENCHMARK_INCLUDE_DIR benchmark/benchmark.h REQUIRED)
find_library(BENCHMARK_LIBRARY benchmark REQUIRED)
include(${CMAKE_CURRENT_LIST_DIR}/bullet.cmake)
file(GLOB bench_sources CONFIGURE_DEPENDS test/benchmark/bench_*.cpp)
# What it shares with the report.
foreach(shared cut_bodies retessellation step_bodies step_runs step_stages timing)
  list(APPEND bench_sources test/benchmark/${shared}.cpp)
endforeach()
add_executable(polyscalpel_test_bench EXCLUDE_FROM_ALL ${bench_sources})
set_target_properties(polyscalpel_test_bench PROPERTIES OUTPUT_NAME polyscalpel_bench
  RUNTIME_OUTPUT_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
target_include_directories(polyscalpel_test_bench PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/test)
target_link_libraries(polyscalpel_test_bench PRIVATE polyscalpel_core ${BENCHMARK_LIBRARY})
add_bullet(polyscalpel_test_bench)
