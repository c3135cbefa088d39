# Compiler flags, sanitizers, output folders: everything that holds for every target.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(ALOFT_SANITIZE "" CACHE STRING "Sanitizers for our code: empty, address, thread, or fuzzer (libFuzzer with address; needs clang)")
set_property(CACHE ALOFT_SANITIZE PROPERTY STRINGS "" address thread fuzzer)

# Instrumented code compiles about twice as fast at -O1, and libraries and programs again in one translation unit each,
# because headers are most of the work; assertions stay on there, to find more.
if(ALOFT_SANITIZE)
  set(CMAKE_CXX_FLAGS_RELEASE "-O1")
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 0)
else()
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
endif()

option(ALOFT_PROGRAMS "Build the programs, which need Fast DDS" ON)
option(ALOFT_PYTHON "Build the Python package: needs nanobind for the Python that CMake finds" OFF)
option(ALOFT_TESTS "Build the tests" ON)
option(ALOFT_BENCHMARKS "Build the benchmarks" ON)
option(ALOFT_REPORT_CHARTS "Build the charts of `aloft report` into the program: needs node, npm and esbuild" ON)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_C_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

# -ffp-contract=off: the same bits whatever instruction set the compiler may use for the rest;
# kernels that want fused multiply-add ask for it by name.
add_library(aloft_options INTERFACE)
target_compile_options(aloft_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor
                       -Wold-style-cast -Woverloaded-virtual -Werror -ffp-contract=off)
# clang's -Wconversion also asks for casts between signed and unsigned, which g++'s does not.
target_compile_options(aloft_options INTERFACE $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>)
target_include_directories(aloft_options INTERFACE "${CMAKE_SOURCE_DIR}")

# g++ takes std::regex for uninitialized when instrumented, and files that share a translation unit have names in common
# and are included; such warnings are for the release build of single files.
if(ALOFT_SANITIZE OR CMAKE_UNITY_BUILD)
  target_compile_options(aloft_options INTERFACE -Wno-shadow
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-subobject-linkage>)
endif()
if(ALOFT_SANITIZE STREQUAL "address")
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=address,undefined)
elseif(ALOFT_SANITIZE STREQUAL "thread")
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=thread)
elseif(ALOFT_SANITIZE STREQUAL "fuzzer")
  add_compile_options(-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -g1)
  add_link_options(-fsanitize=address,undefined)
elseif(ALOFT_SANITIZE)
  message(FATAL_ERROR "ALOFT_SANITIZE is '${ALOFT_SANITIZE}'; allowed: empty, address, thread, fuzzer")
endif()

find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
if(ALOFT_PROGRAMS)
  find_package(spdlog REQUIRED)
endif()
find_package(nlohmann_json REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(Protobuf REQUIRED)
find_package(OpenSSL REQUIRED)
if(ALOFT_TESTS)
  find_package(Catch2 REQUIRED)
  # Options of a test program with which it fails, and does not fail, if no test case matches.
  set(ALOFT_TEST_SOME --warn NoTests)
  set(ALOFT_TEST_ANY "")
  if(Catch2_VERSION VERSION_GREATER_EQUAL 3)
    # The tests are written for Catch2 2, which Debian 13 does not have: there its one header is made from Catch2 3.
    target_include_directories(Catch2::Catch2 INTERFACE "${CMAKE_SOURCE_DIR}/tests/catch2_3")
    set(ALOFT_TEST_SOME "")
    set(ALOFT_TEST_ANY --allow-running-no-tests)
  endif()
  find_package(rapidcheck REQUIRED)
  find_package(valijson REQUIRED)
endif()
