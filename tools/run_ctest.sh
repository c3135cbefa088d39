#!/usr/bin/env bash
# Runs ctest, and says at the end why tests of this build folder were skipped.
# Usage: tools/run_ctest.sh BUILD_FOLDER ctest's arguments...
set -euo pipefail
folder=${1:?tools/run_ctest.sh: name the build folder}
shift
code=0
ctest "$@" || code=$?
grep -s '^SKIPPED: ' "$folder/Testing/Temporary/LastTest.log" || true
exit "$code"
