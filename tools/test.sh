#!/usr/bin/env bash
# Installs, builds and runs the tests.
#   tools/test.sh                  format check, unit, integration and statistics tests
#   tools/test.sh unit             one tier only: unit, integration, statistics or soak
#   tools/test.sh threads          the tests for ThreadSanitizer: of the bus and of services in one process
#   tools/test.sh middleware       what another release's Fast DDS could break first: bus, workers, the quick run
#   tools/test.sh --preset asan    the tests under AddressSanitizer and UBSan (or tsan: ThreadSanitizer); with a tier: only that
#   tools/test.sh --on debian13    the tests on that release of Debian (or debian12), whatever this machine has; as root
#   tools/test.sh --lint           clang-format and clang-tidy over all sources
#   tools/test.sh --all            all of it but soak: lint, both sanitizers, all tests; hours
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() { sed -n '2,10p' "$0" >&2; exit 2; }

preset=release
tier=""
release_of_debian=""
while [ $# -gt 0 ]; do
  case "$1" in
    --preset | --on)
      [ $# -gt 1 ] || usage
      if [ "$1" = --on ]; then release_of_debian=$2; else preset=$2; fi
      shift 2
      ;;
    --lint | --all) [ -z "$release_of_debian" ] || usage ;;&
    --lint) exec tools/lint.sh ;;
    --all)
      tools/setup.sh --for lint
      tools/lint.sh
      tools/test.sh --preset asan
      tools/test.sh --preset tsan
      exec tools/test.sh
      ;;
    unit | integration | statistics | soak | threads | middleware) tier=$1; shift ;;
    *) usage ;;
  esac
done

# A tier installs and builds what it runs, and no more.
case "$tier" in
  unit | statistics | threads | middleware) purpose=tests ;;
  *) purpose=integration ;;
esac
setup=(tools/setup.sh --for "$purpose" "$preset" ${tier:+"tests_$tier"})
if [ -n "$release_of_debian" ]; then
  # The build fetches the chart libraries; the tests have no network but their own.
  tools/on_debian.sh "$release_of_debian" --for "$purpose" --online "${setup[@]}"
  exec tools/on_debian.sh "$release_of_debian" --for "$purpose" tools/test.sh --preset "$preset" ${tier:+"$tier"}
fi
"${setup[@]}"
[ "$preset" != release ] || tools/lint.sh --format-only
folder=build; [ "$preset" = release ] || folder="build-$preset"
if [ -n "$tier" ]; then
  exec tools/run_ctest.sh "$folder" --test-dir "$folder" --output-on-failure --no-tests=error --parallel "$(nproc)" --label-regex "^$tier\$"
fi
exec tools/run_ctest.sh "$folder" --preset "$preset" --no-tests=error --parallel "$(nproc)"
