#!/usr/bin/env bash
# Writes the golden flights (tests/golden/*.txt) and the digest of the quick run anew and shows what changed. Commit them only if the change is meant.
#   tools/golden.sh [build folder]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

build=${1:-build}
if [ ! -f "$build/CMakeCache.txt" ]; then
  echo "tools/golden.sh: there is no build in '$build'; run tools/setup.sh first, or name the build folder" >&2
  exit 2
fi
cmake --build "$build" --target aloft_golden_tests aloft_quick_tests
"$build/bin/aloft_golden_tests" "[regenerate]"
"$build/bin/aloft_quick_tests" "[regenerate]"
git --no-pager diff --stat -p -- tests/golden
git status --short -- tests/golden
