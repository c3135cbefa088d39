# find_package(aloft): the target aloft::plugin, with which a shared object with agents is built. It has headers only: the
# program that loads the plugin has the code.
include(CMakeFindDependencyMacro)
find_dependency(nlohmann_json)

if(NOT TARGET aloft::plugin)
  get_filename_component(aloft_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(aloft::plugin INTERFACE IMPORTED)
  target_include_directories(aloft::plugin INTERFACE "${aloft_prefix}/include/aloft")
  target_link_libraries(aloft::plugin INTERFACE nlohmann_json::nlohmann_json)
  target_compile_features(aloft::plugin INTERFACE cxx_std_20)
  target_compile_options(aloft::plugin INTERFACE -ffp-contract=off)  # the same bytes on every CPU
endif()
