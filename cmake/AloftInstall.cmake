# cmake --install: programs, data and documents under any prefix, and what a plugin is built with (component dev). Nothing
# installed knows its prefix: programs find share/aloft beside their bin/. The exception are systemd's units, which need
# absolute paths and get the prefix when they are installed.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(ALOFT_PROGRAMS aloft aloft-baseline-agent aloft-channel aloft-coordinator aloft-discovery-server aloft-environment
                   aloft-learning-agent aloft-metrics)
install(TARGETS ${ALOFT_PROGRAMS} RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
install(DIRECTORY data/ DESTINATION "${CMAKE_INSTALL_DATADIR}/aloft" COMPONENT runtime)
install(FILES README.md CHANGELOG.md SECURITY.md deploy/systemd/run.env TYPE DOC COMPONENT runtime)
install(FILES LICENSE TYPE DOC RENAME copyright COMPONENT runtime)
install(DIRECTORY docs/ TYPE DOC COMPONENT runtime FILES_MATCHING PATTERN "*.md" PATTERN "*.png" PATTERN "*.svg")

# Man pages, completions and units are made while installing.
install(CODE "
  set(ALOFT_SOURCE \"${CMAKE_SOURCE_DIR}\")
  set(ALOFT_BIN \"${CMAKE_RUNTIME_OUTPUT_DIRECTORY}\")
  set(ALOFT_MADE \"${CMAKE_BINARY_DIR}/installed\")
  set(ALOFT_PROGRAMS ${ALOFT_PROGRAMS})
  include(\"${CMAKE_CURRENT_LIST_DIR}/install_made.cmake\")" COMPONENT runtime)

# Component dev: the headers of common/agents/plugin.hpp and what they include, find_package(aloft), and the example.
set(ALOFT_PLUGIN_HEADERS
    common/agents/agent.hpp common/agents/best_height.hpp common/agents/look.hpp common/agents/observation.hpp
    common/agents/plugin.hpp common/agents/privilege.hpp common/agents/registry.hpp common/agents/site_map.hpp
    common/agents/state_archive.hpp common/agents/steering.hpp common/base/error.hpp common/base/limits.hpp common/base/parameters.hpp
    common/base/random.hpp common/radio/reading.hpp common/world/world.hpp)
foreach(header ${ALOFT_PLUGIN_HEADERS})
  get_filename_component(folder "${header}" DIRECTORY)
  install(FILES "${header}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/aloft/${folder}" COMPONENT dev)
endforeach()
write_basic_package_version_file("${CMAKE_BINARY_DIR}/aloft-config-version.cmake" COMPATIBILITY ExactVersion)
install(FILES cmake/aloft-config.cmake "${CMAKE_BINARY_DIR}/aloft-config-version.cmake" DESTINATION lib/cmake/aloft
        COMPONENT dev)
install(DIRECTORY examples/ DESTINATION "${CMAKE_INSTALL_DOCDIR}/examples" COMPONENT dev)

# cpack: one Debian package per component, with the dependencies that the programs were linked with.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Aloft maintainers <maintainers@aloft.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL runtime dev)
if(ALOFT_PYTHON)
  list(APPEND CPACK_COMPONENTS_ALL python)
  # For the one version of Python that this release of Debian has. Debian has no Gymnasium; it comes by pip.
  math(EXPR next_minor "${ALOFT_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-aloft)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${ALOFT_PYTHON_MINOR}), python3 (<< 3.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pil, python3-pip")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "The simulator as Gymnasium environments for Python.")
endif()
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME aloft)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS nodejs)
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "Programs, data, documents and systemd units.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME aloft-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "aloft (= ${PROJECT_VERSION}), nlohmann-json3-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "cmake, g++")
set(CPACK_COMPONENT_DEV_DESCRIPTION "Headers, a CMake package and an example, for agents of your own.")
include(CPack)
