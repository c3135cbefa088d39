# One function per kind of target, so that every CMakeLists.txt below reads as a list of contents.

# aloft_add_library(NAME SOURCES a.cpp ... [DEPS lib ...] [PRIVATE_DEPS lib ...] [TESTS a_test.cpp ...] [TEST_DEPS lib ...])
# makes the library aloft_NAME, and with TESTS the Catch2 program aloft_NAME_tests in the ctest tier "unit".
function(aloft_add_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;PRIVATE_DEPS;TESTS;TEST_DEPS" ${ARGN})
  add_library(aloft_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(aloft_${name} PUBLIC ${ARG_DEPS} PRIVATE aloft_options ${ARG_PRIVATE_DEPS})
  target_include_directories(aloft_${name} PUBLIC "${CMAKE_SOURCE_DIR}")
  if(ARG_TESTS)
    aloft_add_test(aloft_${name}_tests TIER unit SOURCES ${ARG_TESTS} DEPS aloft_${name} ${ARG_TEST_DEPS})
  endif()
endfunction()

# aloft_add_test(NAME TIER unit|integration|statistics|soak SOURCES ... [DEPS lib ...] [TIMEOUT s])
# soak tests are built, but run only when their label is asked for by name.
function(aloft_add_test name)
  cmake_parse_arguments(ARG "" "TIER;TIMEOUT" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE aloft_options aloft_test_main ${ARG_DEPS})
  target_compile_definitions(${name} PRIVATE ALOFT_SOURCE_DIR="${CMAKE_SOURCE_DIR}" ALOFT_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  add_test(NAME ${name} COMMAND ${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${ARG_TIER}" TIMEOUT ${ARG_TIMEOUT} ENVIRONMENT
    "ASAN_OPTIONS=new_delete_type_mismatch=0;TSAN_OPTIONS=ignore_noninstrumented_modules=1")
endfunction()

# aloft_add_benchmark(NAME SOURCES ... [DEPS lib ...])
function(aloft_add_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE aloft_options benchmark::benchmark benchmark::benchmark_main ${ARG_DEPS})
endfunction()
