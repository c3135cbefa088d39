#!/usr/bin/env bash
# The CPU that processes of a run use while they have nothing to do, in % of a core, and how often they wake up:
#   waiting   a coordinator and a collector that wait for the first worker
#   idle      the same with workers that have joined and find nothing to fly
#   bench/idle.sh [WORKERS] [SECONDS] [DOMAIN]
# Both are measured over SECONDS. Works on a busy machine, too: CPU time is counted, not wall-clock time.
set -euo pipefail
cd "$(dirname "$0")/.."
workers=${1:-2}
seconds=${2:-20}
domain=${3:-59}
bin=${ALOFT_BIN:-build/bin}
run=idle-$$
scratch=$(mktemp -d)
pids=()
end() {
  [ ${#pids[@]} -eq 0 ] || kill "${pids[@]}" 2> /dev/null || true
  wait || true
  rm -rf "$scratch"
}
trap end EXIT

# The workers fly only min-height and are soon idle; constant-60 waits for a worker that flies it.
cat > "$scratch/experiment.json" << 'JSON'
{"name": "idle", "trials": 2, "agents": ["min-height", "constant-60", "dqn"],
 "world": {"kind": "generated", "bs_density_per_km2": 1, "steps": 20}}
JSON

start() { "$bin/aloft" "$@" --domain "$domain" > /dev/null 2>> "$scratch/err" & pids+=($!); }

# family PID: the process and its children.
family() { echo "$1"; pgrep -P "$1" || true; }

# sample FILE: per process its CPU in ns, its wake-ups and its name.
sample() {
  local pid
  for pid in $(for pid in "${pids[@]}"; do family "$pid"; done); do
    awk -v pid="$pid" -v name="$(tr '\0' ' ' < "/proc/$pid/cmdline" | awk '{n = $1; sub(".*/", "", n); print (n == "aloft" ? n " " $2 : n)}')" '
      FILENAME ~ /schedstat$/ {cpu += $1} /^voluntary_ctxt_switches/ {wakes += $2} END {print pid, cpu, wakes, name}' \
      /proc/"$pid"/task/*/schedstat /proc/"$pid"/task/*/status
  done > "$1"
}

# report: the mean over the processes of one kind. The four processes of a worker are summed.
report() {
  sample "$scratch/before"
  sleep "$seconds"
  sample "$scratch/after"
  awk -v s="$seconds" '
    {name = $4 ($5 ? " " $5 : "")}
    NR == FNR {cpu[$1] = $2; wakes[$1] = $3; next}
    {c = 100 * ($2 - cpu[$1]) / 1e9 / s; w = ($3 - wakes[$1]) / s; n[name]++; sum[name] += c; all[name] += w}
    END {for (k in n) {printf "%-22s %9.2f %10.0f\n", k, sum[k] / n[k], all[k] / n[k] | "sort"}
         close("sort")
         four = sum["aloft-environment"] + sum["aloft-channel"] + sum["aloft-learning-agent"] + sum["aloft-baseline-agent"]
         if (n["aloft-channel"]) printf "%-22s %9.2f\n", "one worker, all four", four / n["aloft-channel"]}' "$scratch/before" "$scratch/after"
}

alive() { "$bin/aloft" status --run "$run" --domain "$domain" --format json 2> /dev/null | grep -c '"state": "alive"' || true; }

start coordinator "$scratch/experiment.json" --run "$run" --out "$scratch/out"
start metrics "$scratch/experiment.json" --run "$run" --out "$scratch/out"
sleep 3
printf '%-22s %9s %10s\n' "no worker" "% of core" "wake-ups/s"
report
for _ in $(seq "$workers"); do start worker --join "$run" --agents min-height --log-dir "$scratch/log"; done
deadline=$((SECONDS + 60))
while [ "$(alive)" -ne "$workers" ]; do
  if [ $SECONDS -gt $deadline ]; then cat "$scratch/err" >&2; echo "bench/idle.sh: not all of $workers workers joined" >&2; exit 1; fi
done
sleep 3
printf '\n%-22s %9s %10s\n' "$workers workers" "% of core" "wake-ups/s"
report
