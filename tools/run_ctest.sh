#!/usr/bin/env bash
# Runs ctest, and says why tests of this build folder were skipped, just above the counts with which ctest ends.
# Usage: tools/run_ctest.sh BUILD_FOLDER ctest's arguments...
set -euo pipefail
folder=${1:?tools/run_ctest.sh: name the build folder}
shift
ctest "$@" | awk -v log_file="$folder/Testing/Temporary/LastTest.log" '
  closing || /^[0-9]+% tests passed/ { closing = 1; counts = counts $0 "\n"; next }
  { print; fflush() }
  END {
    while ((getline line < log_file) > 0) if (line ~ /^SKIPPED: /) print line
    printf "%s", counts
  }'
