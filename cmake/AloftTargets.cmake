# One function per kind of target, so that every CMakeLists.txt below reads as a list of contents.

# All that users start, without tests and benchmarks.
add_custom_target(programs)

# aloft_add_library(NAME SOURCES a.cpp ... [DEPS lib ...] [PRIVATE_DEPS lib ...] [TESTS a_test.cpp ...] [TEST_DEPS lib ...]
#                   [TESTS_USE_THREADS] [TESTS_NEED x ...] [FOR_TESTS])
# makes the library aloft_NAME, and with TESTS the Catch2 program aloft_NAME_tests in the ctest tier "unit". FOR_TESTS:
# only tests use the library. Without ALOFT_TESTS there are neither tests nor libraries for them.
function(aloft_add_library name)
  cmake_parse_arguments(ARG "TESTS_USE_THREADS;FOR_TESTS" "" "SOURCES;DEPS;PRIVATE_DEPS;TESTS;TEST_DEPS;TESTS_NEED" ${ARGN})
  if(ARG_FOR_TESTS AND NOT ALOFT_TESTS)
    return()
  endif()
  add_library(aloft_${name} STATIC ${ARG_SOURCES})
  target_link_libraries(aloft_${name} PUBLIC ${ARG_DEPS} PRIVATE aloft_options ${ARG_PRIVATE_DEPS})
  target_include_directories(aloft_${name} PUBLIC "${CMAKE_SOURCE_DIR}")
  if(ARG_TESTS)
    set(use_threads "")
    if(ARG_TESTS_USE_THREADS)
      set(use_threads USE_THREADS)
    endif()
    aloft_add_test(aloft_${name}_tests TIER unit ${use_threads} SOURCES ${ARG_TESTS} DEPS aloft_${name} ${ARG_TEST_DEPS}
      NEEDS ${ARG_TESTS_NEED})
  endif()
endfunction()

# What sanitized programs need to ignore in the middleware.
set(ALOFT_SANITIZER_ENVIRONMENT ASAN_OPTIONS=new_delete_type_mismatch=0:verify_asan_link_order=0 TSAN_OPTIONS=ignore_noninstrumented_modules=1)

# aloft_add_test_entries(NAME PROGRAM LABELS x ... SERIAL ON|OFF TIMEOUT s ENVIRONMENT ...): the ctest entries of a test
# program. Test cases that cannot run on every machine have the tag [needs-X], and for each X in the program's NEEDS an
# entry of their own, NAME_needs_X, which says "skipped" where they cannot (tests/skip.hpp). Hidden test cases run only
# when they are asked for by name.
function(aloft_add_test_entries name program)
  cmake_parse_arguments(ARG "" "SERIAL;TIMEOUT" "LABELS;ENVIRONMENT" ${ARGN})
  get_target_property(needs ${program} ALOFT_NEEDS)
  set(entries ${name})
  set(what_runs_everywhere "")
  foreach(need ${needs})
    list(APPEND entries ${name}_needs_${need})
    string(APPEND what_runs_everywhere "~[needs-${need}]")
    add_test(NAME ${name}_needs_${need} COMMAND ${program} "[needs-${need}]~[.]" ${ALOFT_TEST_SOME} WORKING_DIRECTORY "${CMAKE_SOURCE_DIR}")
    set_tests_properties(${name}_needs_${need} PROPERTIES SKIP_RETURN_CODE 77)
  endforeach()
  if(needs)
    string(APPEND what_runs_everywhere "~[.]")  # Catch2 takes what only leaves out for a wish to run hidden test cases too
  endif()
  add_test(NAME ${name} COMMAND ${program} ${what_runs_everywhere} ${ALOFT_TEST_ANY} WORKING_DIRECTORY "${CMAKE_SOURCE_DIR}")
  set_tests_properties(${entries} PROPERTIES LABELS "${ARG_LABELS}" RUN_SERIAL ${ARG_SERIAL} TIMEOUT ${ARG_TIMEOUT}
    ENVIRONMENT "${ARG_ENVIRONMENT}")
endfunction()

# aloft_add_test(NAME TIER unit|integration|statistics|soak SOURCES ... [DEPS lib ...] [TIMEOUT s] [USE_THREADS] [MIDDLEWARE] [NEEDS x ...])
# soak tests are built, but run only when their label is asked for by name. Sanitized builds leave out statistics tests
# (the same code as the unit tests, a hundred times longer), and under ThreadSanitizer also unit tests of one thread. Its label
# "threads" is on all tests of the bus and the services that run in one process, and on all others with USE_THREADS.
# The label "middleware" is on what another Fast DDS could break first: the tests of the bus, and those with MIDDLEWARE.
# Tests of properties (rc::check) draw the same cases in each run of CTest, so that an unrelated change never meets a new one;
# the program itself draws others each time: RC_PARAMS=max_success=2000 looks for what the hundred cases of CTest did not meet.
# The target tests_TIER (tests_threads, tests_middleware) builds the tests of a tier and what they start.
if(ALOFT_TESTS)
  foreach(label unit integration statistics soak threads middleware)
    add_custom_target(tests_${label})
  endforeach()
endif()

function(aloft_add_test name)
  cmake_parse_arguments(ARG "USE_THREADS;MIDDLEWARE" "TIER;TIMEOUT" "SOURCES;DEPS;NEEDS" ${ARGN})
  if(NOT ALOFT_TESTS)
    return()
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE aloft_options aloft_test_main ${ARG_DEPS})
  # In a unity build tests stay apart: their helpers are called alike from file to file.
  set_target_properties(${name} PROPERTIES ALOFT_NEEDS "${ARG_NEEDS}" UNITY_BUILD OFF)
  # Most of what is compiled are tests, and what they test is optimised in its library: a fifth to a third less time.
  target_compile_options(${name} PRIVATE -O1)
  set(labels ${ARG_TIER})
  if(ARG_USE_THREADS OR "${CMAKE_CURRENT_SOURCE_DIR}/" MATCHES "^${CMAKE_SOURCE_DIR}/(common/bus|services)/")
    list(APPEND labels threads)
  endif()
  if(ARG_MIDDLEWARE OR "${CMAKE_CURRENT_SOURCE_DIR}/" MATCHES "^${CMAKE_SOURCE_DIR}/common/bus/")
    list(APPEND labels middleware)
  endif()
  if((ALOFT_SANITIZE AND ARG_TIER STREQUAL "statistics")
     OR (ALOFT_SANITIZE STREQUAL "thread" AND labels STREQUAL "unit"))
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  endif()
  foreach(label ${labels})
    add_dependencies(tests_${label} ${name})
  endforeach()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(ALOFT_SANITIZE)
    math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * 5")
  endif()
  set(serial OFF)
  if(NOT ARG_TIER STREQUAL "unit")
    set(serial ON)  # each takes all cores
  endif()
  aloft_add_test_entries(${name} ${name} LABELS ${labels} SERIAL ${serial} TIMEOUT ${ARG_TIMEOUT}
    ENVIRONMENT ${ALOFT_SANITIZER_ENVIRONMENT} RC_PARAMS=seed=1)
endfunction()

# aloft_add_benchmark(NAME SOURCES ... [DEPS lib ...]); sanitized builds leave benchmarks out.
function(aloft_add_benchmark name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE aloft_options benchmark::benchmark benchmark::benchmark_main ${ARG_DEPS})
  if(ALOFT_SANITIZE)
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
  endif()
endfunction()
