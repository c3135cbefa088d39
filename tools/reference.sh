#!/usr/bin/env bash
# Writes what is made from the tables in the code: docs/reference/, data/schema/ and the table of roles in SECURITY.md.
# Shows what changed; commit it together with the change of the tables.
#   tools/reference.sh [build folder]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build}
if [ ! -f "$build/CMakeCache.txt" ]; then
  echo "tools/reference.sh: there is no build in '$build'; run tools/setup.sh first, or name the build folder" >&2
  exit 2
fi
cmake --build "$build" --target aloft_reference_tests aloft_experiment_tests aloft_wire_limits_tests
"$build/bin/aloft_reference_tests" "[regenerate]"
"$build/bin/aloft_wire_limits_tests" "[regenerate]"
ALOFT_WRITE_SCHEMA=1 "$build/bin/aloft_experiment_tests" "data/schema*"
git --no-pager diff --stat -p -- docs/reference data/schema SECURITY.md
git status --short -- docs/reference data/schema SECURITY.md
