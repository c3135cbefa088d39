# cmake -D SOURCE_DIR=... -D VERSION=... -D TOOLS=... -D INPUT=... -D OUTPUT=... -P build_info.cmake
# Writes OUTPUT from INPUT, but only if it changes. Outside a git checkout the build id is the version without a commit.
execute_process(
  COMMAND git describe --always --dirty --abbrev=12 --exclude=*
  WORKING_DIRECTORY "${SOURCE_DIR}"
  OUTPUT_VARIABLE commit
  OUTPUT_STRIP_TRAILING_WHITESPACE
  ERROR_QUIET
  RESULT_VARIABLE failed)
if(failed)
  set(ALOFT_BUILD_ID "${VERSION} ${TOOLS}")
else()
  set(ALOFT_BUILD_ID "${VERSION}+${commit} ${TOOLS}")
endif()
configure_file("${INPUT}" "${OUTPUT}" @ONLY)
