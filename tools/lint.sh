#!/usr/bin/env bash
# clang-format and clang-tidy over all sources. clang-tidy skips what has not changed, what it includes and settings
# included, since it last passed (build/lint/ remembers).
#   tools/lint.sh [--format-only | --core]    --core: clang-tidy over common/ only, without its tests and the bus
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Other versions of the linters judge differently, so one release of Debian judges.
if [ "$(. /etc/os-release && echo "$ID ${VERSION_ID:-}")" != "debian 12" ]; then
  echo "tools/lint.sh: format and code are checked on Debian 12, which has clang-format-16 and clang-tidy-16" >&2
  [ "${1:-}" = --format-only ] || exit 2
  exit 0
fi
if [ "${1:-}" = --format-only ]; then tools/setup.sh --for tests --install; else tools/setup.sh --for lint --install; fi
mapfile -t sources < <(git ls-files '*.cpp' '*.hpp' '*.c' '*.h')
clang-format-16 --dry-run --Werror "${sources[@]}"
[ "${1:-}" != --format-only ] || exit 0

# One translation unit per library and program, but not of tests (CMake's unity build): headers, most of the work, are read
# once for it instead of once per file.
lint=build/lint
cmake --preset release -B "$lint" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 >/dev/null
cmake --build "$lint" --target aloft_wire aloft_proto aloft_export_proto aloft_build_info >/dev/null  # generated sources
mkdir -p "$lint/passed"
# For each unit a line: its file, and the files of this checkout that it includes.
{ clang-scan-deps-16 -j "$(nproc)" --compilation-database "$lint/compile_commands.json" 2> /dev/null || true; } |
  awk -v checkout="$PWD/" '/^[^ ]/ { print "" } { for (i = 1; i <= NF; ++i) if (index($i, checkout) == 1) printf "%s ", $i }' > "$lint/includes"
export lint
check() {
  local files stamp
  files=$(awk -v unit="$1" '$1 == unit' "$lint/includes")
  stamp=$lint/passed/$(cat .clang-tidy ${files:-"$1"} | sha256sum | cut -d' ' -f1)
  [ -z "$files" ] || [ ! -f "$stamp" ] || return 0
  local checks=-bugprone-suspicious-include
  # What tests do once need not be fast, a test case tells one story, and a comparison with "" shows what was there instead.
  [[ $1 != *_test.cpp && $1 != */tests/* ]] || checks+=",-performance-*,-readability-container-size-empty,-readability-function-size"
  # Boost 1.74 does not know that clang has coroutines with the GNU library.
  local coroutines=(--extra-arg=-DBOOST_ASIO_HAS_CO_AWAIT=1 --extra-arg=-DBOOST_ASIO_HAS_STD_COROUTINE=1)
  # Seconds of CPU time, which do not depend on what else the machine does.
  (ulimit -t 900; exec clang-tidy-16 --quiet --extra-arg=-Wno-shadow "${coroutines[@]}" --checks="$checks" -p "$lint" "$1" 2> /dev/null) ||
    { echo "clang-tidy: $1 failed, or took longer than 15 minutes of CPU time" >&2; return 1; }
  touch "$stamp"
}
export -f check
left_out=(-e '/idl/' -e '\.pb\.cc$' -e '\.c$')
[ "${1:-}" != --core ] || left_out+=(-e '_test\.cpp$' -e '/tests/' -e '/bench/' -e '/services/' -e '/tools/' -e '/bus/')
sed -n 's/^ *"file": "\(.*\)".*$/\1/p' "$lint/compile_commands.json" | grep -v "${left_out[@]}" |
  xargs -P "$(nproc)" -I{} bash -c 'check {}'
