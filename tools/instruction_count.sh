#!/usr/bin/env bash
# Counts the instructions of fixed pieces of work (flights, training, a radio table) with callgrind and compares them with
# bench/instruction_counts.json: more than 5 % off fails. Counts do not depend on how busy the machine is. valgrind knows no
# AVX-512, so the AVX2 kernels are counted. About two minutes.
#   tools/instruction_count.sh            compare
#   tools/instruction_count.sh --update   store what is counted now; commit it together with its reason
set -euo pipefail
cd "$(dirname "$0")/.."
stored=bench/instruction_counts.json
update=${1:-}
if [ $# -gt 1 ] || { [ -n "$update" ] && [ "$update" != --update ]; }; then
  echo "usage: tools/instruction_count.sh [--update]" >&2
  exit 2
fi
if ! command -v valgrind > /dev/null; then
  echo "tools/instruction_count.sh needs valgrind: apt-get install valgrind" >&2
  exit 2
fi
if ! grep -qw avx2 /proc/cpuinfo; then
  echo "tools/instruction_count.sh needs a CPU with AVX2: the stored figures are of its kernels" >&2
  exit 2
fi
[ -f build/build.ninja ] || cmake --preset release
cmake --build build --target instruction_work > /dev/null
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

failed=0
counts=()
printf '%-24s %16s %16s %8s\n' work stored now change
for work in $(build/bin/instruction_work); do
  valgrind --tool=callgrind --toggle-collect=counted_work --callgrind-out-file="$scratch/out" \
    build/bin/instruction_work "$work" > "$scratch/log" 2>&1 || { cat "$scratch/log" >&2; exit 1; }
  now=$(awk '/^(summary|totals):/ {print $2; exit}' "$scratch/out")
  counts+=("  \"$work\": $now")
  before=$(awk -v name="\"$work\":" '$1 == name {sub(",", "", $2); print $2}' "$stored" 2> /dev/null || true)
  change=$(awk -v a="${before:-0}" -v b="$now" 'BEGIN {if (a > 0) printf "%+.1f", 100 * (b - a) / a; else print "new"}')
  printf '%-24s %16s %16s %7s%%\n' "$work" "${before:--}" "$now" "$change"
  awk -v c="$change" 'BEGIN {exit !(c == "new" || c > 5 || c < -5)}' && failed=1
done
if [ "$update" = --update ]; then
  { echo "{"; (IFS=$'\n'; echo "${counts[*]}") | sed '$!s/$/,/'; echo "}"; } > "$stored"
  echo "stored in $stored"
  exit 0
fi
if [ "$failed" = 1 ]; then
  echo "More than 5 % off. If that is meant, store it: tools/instruction_count.sh --update" >&2
  exit 1
fi
