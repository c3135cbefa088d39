#!/usr/bin/env bash
# Installs, builds and runs the tests.
#   tools/test.sh                  format check, unit, integration and statistics tests
#   tools/test.sh unit             one tier only: unit, integration, statistics or soak
#   tools/test.sh --preset asan    the tests under AddressSanitizer and UBSan (or tsan: ThreadSanitizer)
#   tools/test.sh --lint           clang-format and clang-tidy over all sources
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
tier=""
while [ $# -gt 0 ]; do
  case "$1" in
    --preset) preset=${2:?tools/test.sh: --preset needs release, asan or tsan}; shift 2 ;;
    --lint) exec tools/lint.sh ;;
    unit | integration | statistics | soak) tier=$1; shift ;;
    *) sed -n '2,7p' "$0" >&2; exit 2 ;;
  esac
done

tools/setup.sh "$preset"
[ "$preset" != release ] || tools/lint.sh --format-only
if [ -n "$tier" ]; then
  folder=build; [ "$preset" = release ] || folder="build-$preset"
  exec ctest --test-dir "$folder" --output-on-failure -L "^$tier\$"
fi
exec ctest --preset "$preset"
