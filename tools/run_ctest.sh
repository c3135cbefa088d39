#!/usr/bin/env bash
# Runs ctest, and says why tests of this build folder were skipped, just above the counts with which ctest ends.
# Usage: tools/run_ctest.sh BUILD_FOLDER ctest's arguments...
set -euo pipefail
folder=${1:?tools/run_ctest.sh: name the build folder}
shift
# Not awk: Debian's reads a pipe in blocks, so that nothing is seen of a tier until it is over.
ctest "$@" | {
  counts=""
  while IFS= read -r line; do
    if [ -n "$counts" ] || [[ $line =~ ^[0-9]+%\ tests\ passed ]]; then counts+=$line$'\n'; else printf '%s\n' "$line"; fi
  done
  log=$folder/Testing/Temporary/LastTest.log
  [ ! -f "$log" ] || sed -n '/^SKIPPED: /p' "$log"
  printf '%s' "$counts"
}
