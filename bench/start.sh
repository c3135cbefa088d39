#!/usr/bin/env bash
# How long a run takes from its command to its first stored flight, and how much memory a worker takes.
#   bench/start.sh [WORKERS] [TIMES] [DOMAIN]
# Start: median of TIMES runs with WORKERS workers, until the collector logs that the first flight is in the database.
# Memory: one worker while it flies eight agents, one of them the DQN: PSS (private pages, and its share of shared ones)
# of its four processes, the largest sum of all samples.
set -euo pipefail
cd "$(dirname "$0")/.."
workers=${1:-4}
times=${2:-5}
domain=${3:-59}
bin=${ALOFT_BIN:-build/bin}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

for i in $(seq "$times"); do
  begun=$(date +%s.%N)
  "$bin/aloft" run data/experiments/quick.json --trials 2 --agents min-height --workers "$workers" --domain "$domain" \
    --out "$scratch/$i" > /dev/null 2> "$scratch/err" || { cat "$scratch/err" >&2; exit 1; }
  stored=$(awk '/has stored its first flight/ {print $1; exit}' "$scratch/$i/log/aloft-metrics.log")
  awk -v a="$begun" -v b="$(date -d "$stored" +%s.%N)" 'BEGIN {printf "%.2f\n", b - a}'
done | sort -n > "$scratch/times"
echo "start of $workers workers to the first stored flight: $(sed -n "$(((times + 1) / 2))p" "$scratch/times") s" \
  "(of $times: $(paste -sd' ' "$scratch/times"))"

"$bin/aloft" run data/experiments/quick.json --trials 2 --workers 1 --domain "$domain" --out "$scratch/memory" \
  > /dev/null 2> "$scratch/err" &
run=$!
while kill -0 $run 2> /dev/null; do
  for pid in $(pgrep -P $run -f -- '--worker w0' || true); do
    awk -v name="$(tr '\0' ' ' < "/proc/$pid/cmdline" | sed 's/ .*//; s,.*/,,')" '/^Pss:/ {print name, $2 / 1024}' \
      "/proc/$pid/smaps_rollup" 2> /dev/null || true
  done > "$scratch/sample"
  awk '{sum += $2} END {print sum + 0}' "$scratch/sample" > "$scratch/sum"
  if awk -v a="$(cat "$scratch/sum")" -v b="$(cat "$scratch/most" 2> /dev/null || echo 0)" 'BEGIN {exit !(a > b)}'; then
    mv "$scratch/sum" "$scratch/most"
    mv "$scratch/sample" "$scratch/largest"
  fi
  sleep 0.3
done
wait $run || { cat "$scratch/err" >&2; exit 1; }
awk '{printf "%s%s %.1f", (NR > 1 ? ", " : ""), $1, $2; sum += $2} END {printf "; one worker: %.1f MB\n", sum}' \
  "$scratch/largest" | sed 's/^/memory, PSS in MB: /'
