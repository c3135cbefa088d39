#!/usr/bin/env bash
# Feeds made-up input to everything that reads data from outside, under AddressSanitizer and UBSan (libFuzzer, Debian 12).
#   tools/fuzz.sh [MINUTES [TARGET ...]]    MINUTES (5) for each TARGET (all of tests/fuzz)
# Prints a table. Ends with 1 if anything was found: the inputs are then in tests/fuzz/found/TARGET/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
refuse() { echo "tools/fuzz.sh: $*" >&2; exit 2; }

mapfile -t all < <(sed -n 's/^aloft_add_fuzzer(\([a-z_]*\) .*/\1/p' tests/fuzz/CMakeLists.txt)
minutes=${1-5}
[[ $minutes =~ ^[1-9][0-9]{0,3}$ && $minutes -le 1440 ]] || refuse "MINUTES is '$minutes'; use a whole number from 1 to 1440"
shift $(($# > 0))
[ $# -gt 0 ] || set -- "${all[@]}"
for target in "$@"; do
  [[ " ${all[*]} " == *" $target "* ]] || refuse "unknown target '$target'; use ${all[*]}"
done
[ "$(. /etc/os-release && echo "$ID ${VERSION_ID:-}")" = "debian 12" ] || refuse "the fuzzers are built on Debian 12, with its clang-16"

tools/setup.sh --for fuzz fuzz aloft_fuzzers
work=$PWD/build-fuzz/fuzz
mkdir -p "$work"
build-fuzz/bin/aloft_fuzz_seeds "$work/seeds"

# Inputs that reach new code stay in build-fuzz/fuzz/TARGET for the next call.
fuzz() {
  local target=$1 folders=("$work/$1" "$work/seeds/$1")
  local found=$PWD/tests/fuzz/found/$target/
  mkdir -p "$found" "$work/$target"
  [ ! -d "tests/fuzz/corpus/$target" ] || folders+=("tests/fuzz/corpus/$target")
  ASAN_OPTIONS=new_delete_type_mismatch=0 "build-fuzz/bin/aloft_fuzz_$target" -max_total_time=$((minutes * 60)) -timeout=20 \
    -rss_limit_mb=2048 -malloc_limit_mb=512 -print_final_stats=1 -artifact_prefix="$found" "${folders[@]}" > "$work/$target.log" 2>&1 ||
    echo "$target" >> "$work/failed"
}
export -f fuzz
export work minutes
rm -f "$work/failed"
printf '%s\n' "$@" | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}'

printf '%-16s %12s %10s  %s\n' target executions coverage finding
for target in "$@"; do
  executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/$target.log")
  coverage=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$work/$target.log" | tail -n 1)
  finding=none
  if grep -qsx "$target" "$work/failed"; then
    finding=$(sed -n 's/^SUMMARY: //p' "$work/$target.log" | head -n 1)
    finding=${finding:-"see $work/$target.log"}
  fi
  printf '%-16s %12s %10s  %s\n' "$target" "${executions:-?}" "${coverage:-?}" "$finding"
done
[ -e "$work/failed" ] || exit 0
echo
for target in $(cat "$work/failed"); do
  for input in "tests/fuzz/found/$target"/*; do echo "build-fuzz/bin/aloft_fuzz_$target $input"; done
done
cat << 'END'
These commands show each finding again. Mend the code, then move the input to tests/fuzz/corpus/TARGET/ under a name that says
what was wrong: the unit tests replay it from then on.
END
exit 1
