# Makes ALOFT_REPORT_PAGE: the page with its scripts and the chart libraries, without data.
find_program(NODE_PROGRAM node)
find_program(NPM_PROGRAM npm)
find_program(ESBUILD_PROGRAM esbuild)
if(NOT NODE_PROGRAM OR NOT NPM_PROGRAM OR NOT ESBUILD_PROGRAM)
  message(FATAL_ERROR "The report's charts need 'node', 'npm' and 'esbuild' at build time: install the packages nodejs, npm and esbuild (tools/setup.sh does), then configure again, or leave them out with -DALOFT_REPORT_CHARTS=OFF.")
endif()

set(ALOFT_REPORT_MODULES "${CMAKE_CURRENT_BINARY_DIR}/node_modules")
set(ALOFT_REPORT_PAGE "${CMAKE_CURRENT_BINARY_DIR}/report_page.html")

# The chart libraries, exactly as the lock file has them; nothing is kept in the sources.
add_custom_command(
  OUTPUT "${ALOFT_REPORT_MODULES}/.installed"
  COMMAND "${CMAKE_COMMAND}" -E copy package.json package-lock.json .npmrc "${CMAKE_CURRENT_BINARY_DIR}"
  COMMAND "${CMAKE_COMMAND}" -E chdir "${CMAKE_CURRENT_BINARY_DIR}" "${NPM_PROGRAM}" ci --ignore-scripts --no-progress --loglevel=error
  COMMAND "${CMAKE_COMMAND}" -E touch "${ALOFT_REPORT_MODULES}/.installed"
  DEPENDS package.json package-lock.json .npmrc
  WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  COMMENT "Fetching the chart libraries (npm ci)"
  VERBATIM)

set(page_sources
    page/page.html page/style.css page/format.js page/privilege.js page/theme.js page/charts_statistics.js page/charts_swept.js page/charts_flight.js page/charts.js page/dom.js page/filter.js
    page/sections.js page/page.js)
add_custom_command(
  OUTPUT "${ALOFT_REPORT_PAGE}"
  COMMAND "${NODE_PROGRAM}" bundle.mjs "${ESBUILD_PROGRAM}" "${ALOFT_REPORT_MODULES}" "${ALOFT_REPORT_PAGE}"
  DEPENDS bundle.mjs ${page_sources} "${ALOFT_REPORT_MODULES}/.installed"
  WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
  COMMENT "Bundling the report page"
  VERBATIM)
