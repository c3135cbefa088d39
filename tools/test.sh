#!/usr/bin/env bash
# Installs, builds and runs the tests.
#   tools/test.sh                  format check, unit, integration and statistics tests
#   tools/test.sh unit             one tier only: unit, integration, statistics or soak
#   tools/test.sh threads          the tests for ThreadSanitizer: of the bus and of services in one process
#   tools/test.sh --preset asan    the tests under AddressSanitizer and UBSan (or tsan: ThreadSanitizer); with a tier: only that
#   tools/test.sh --lint           clang-format and clang-tidy over all sources
#   tools/test.sh --all            all of it but soak: lint, both sanitizers, all tests; hours
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=release
tier=""
while [ $# -gt 0 ]; do
  case "$1" in
    --preset) preset=${2:?tools/test.sh: --preset needs release, asan or tsan}; shift 2 ;;
    --lint) exec tools/lint.sh ;;
    --all)
      tools/setup.sh --for lint
      tools/lint.sh
      tools/test.sh --preset asan
      tools/test.sh --preset tsan
      exec tools/test.sh
      ;;
    unit | integration | statistics | soak | threads) tier=$1; shift ;;
    *) sed -n '2,8p' "$0" >&2; exit 2 ;;
  esac
done

# A tier installs and builds what it runs, and no more.
case "$tier" in
  unit | statistics | threads) purpose=tests ;;
  *) purpose=integration ;;
esac
tools/setup.sh --for "$purpose" "$preset" ${tier:+"tests_$tier"}
[ "$preset" != release ] || tools/lint.sh --format-only
folder=build; [ "$preset" = release ] || folder="build-$preset"
if [ -n "$tier" ]; then
  exec tools/run_ctest.sh "$folder" --test-dir "$folder" --output-on-failure --no-tests=error --parallel "$(nproc)" --label-regex "^$tier\$"
fi
exec tools/run_ctest.sh "$folder" --preset "$preset" --no-tests=error --parallel "$(nproc)"
