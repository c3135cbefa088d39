#!/usr/bin/env bash
# Measures where the time goes on this machine and writes docs/performance.md. Less than half an hour, 5 GB of disk for the
# largest database; best when nothing else runs.
#   tools/performance.sh [FILE]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-docs/performance.md}
domain=${ALOFT_PERFORMANCE_DOMAIN:-59}  # DDS domain of the runs

[ -f build/build.ninja ] || cmake --preset release
cmake --build build --target aloft aloft-environment aloft-channel aloft-learning-agent aloft-baseline-agent aloft-coordinator \
  aloft-metrics learn_benchmark flight_parts environment_steps radio_benchmark bus_round_trip bus_worker scaling coordinator_benchmark \
  fake_workers aloft_python >&2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
bin=build/bin

say() { echo "$*" >&2; }
code() { echo '```'; cat; echo '```'; }

# profile NAME ARGS...: aloft ARGS..., sampled: per kind of process the CPU seconds and the largest memory of one.
profile() {
  local name=$1 start end aloft child
  shift
  start=$(date +%s.%N)
  $bin/aloft "$@" --domain "$domain" --out "$scratch/$name" > /dev/null 2> "$scratch/$name.err" &
  aloft=$!
  while kill -0 $aloft 2> /dev/null; do
    for child in $aloft $(pgrep -P $aloft || true); do
      awk -v pid="$child" 'FILENAME ~ /stat$/ {sub(/.*\) /, ""); cpu = ($12 + $13) / 100} /^Name:/ {n = $2} /^VmHWM:/ {m = $2 / 1024}
        END {if (n) print pid, n, cpu, m}' "/proc/$child/stat" "/proc/$child/status" 2> /dev/null || true
    done >> "$scratch/$name.samples"
    sleep 0.1
  done
  wait $aloft || { cat "$scratch/$name.err" >&2; exit 1; }
  end=$(date +%s.%N)
  awk -v wall="$(echo "$start $end" | awk '{print $2 - $1}')" '
    {cpu[$1] = $3; name[$1] = $2; if ($4 > memory[$2]) memory[$2] = $4}
    END {
      for (pid in cpu) {sum[name[pid]] += cpu[pid]; all += cpu[pid]}
      for (n in sum) printf "| %s | %.1f | %.1f %% | %.0f |\n", n, sum[n], 100 * sum[n] / all, memory[n] | "sort -t\"|\" -k3 -rn"
      close("sort -t\"|\" -k3 -rn")
      printf "\nWall time %.1f s, CPU time %.1f s.\n", wall, all
    }' "$scratch/$name.samples"
}

# The names as Linux cuts them to 15 characters, made whole again.
whole_names() {
  sed 's/aloft-learning- /aloft-learning-agent /; s/aloft-baseline- /aloft-baseline-agent /; s/aloft-environme /aloft-environment /; s/aloft-coordinat /aloft-coordinator /'
}

# growth FILTER: one row per argument, with the time per base station.
growth() {
  $bin/radio_benchmark --benchmark_filter="^$1" --benchmark_format=csv 2> /dev/null |
    awk -F, 'NR > 1 && $1 ~ /se_table/ {gsub(/"/, "", $1); sub(/se_table_largest.*/, ":300 in a window of 10 km", $1); sub(/.*:/, "", $1);
      printf "| %s | %.0f | %.1f | %.2f |\n", $1, $NF, $4, 1000 * $4 / $NF}'
}

write() {
  cat << 'TEXT'
# Performance
Written by `tools/performance.sh`; measure your own machine with it. Times on a busy machine are too long: what counts are
ratios, which are measured in turns within one run.

TEXT
  echo "Machine: $(sed -n 's/^model name\s*: //p' /proc/cpuinfo | head -1), $(nproc) cores used, $(grep -qw avx512f /proc/cpuinfo && echo AVX-512 || echo 'no AVX-512')."
  echo "Load while measuring: $(cut -d' ' -f1 /proc/loadavg) (what other programs ran beside it)."

  say "training ..."
  cat << 'TEXT'

## Training
One gradient step of the paper's network (38-39-200-200-200-3, batch 16, Adam). The floor is the time of its arithmetic,
9.30 million operations, at the rate of a loop of nothing but multiply-adds: as if a root or a quotient took no longer
than a sum. The last column compares with the matrix products alone, 8.58 million, as if Adam took no time at all.
avx2 and avx512 give the same bits.
TEXT
  $bin/learn_benchmark | code
  cat << 'TEXT'
Zeros are skipped where that changes no sum: units that are dead for the whole minibatch, and in the weight gradients
most samples whose ReLU is off. The difference between the random minibatches and the DQN's flight is what dead units
give. The rest of the way to the floor is Adam, half of the time of a step: it reads and writes all weights and both
moments, 1.1 MB, which is more than the first-level cache holds.
TEXT
  say "widths ..."
  cat << 'TEXT'

`build/bin/learn_benchmark --widths 64..512`: the same networks with other widths of the hidden layers, so that weights and
moments (MB) fill one cache after the other; first the caches and what a loop of multiply-adds in place reads and
writes in each. KB: what a step reads from a cache because no nearer one has it, counted by a model of caches that keep
what was used last; transfer: the microseconds this takes at the measured bandwidth if nothing is computed meanwhile.
TEXT
  $bin/learn_benchmark --widths 64..512 | code
  if [ -x $bin/libtorch_benchmark ]; then
    say "libtorch ..."
    echo
    echo "Beside libtorch (\`tools/benchmark_libtorch.sh\` installs it and runs this alone), one thread, the same minibatches:"
    OMP_NUM_THREADS=1 $bin/libtorch_benchmark | code
  fi

  say "one flight ..."
  cat << 'TEXT'

## Where the time of a DQN's flight goes
CPU time in one process (`build/bin/flight_parts`), 5 base stations per km2.
TEXT
  $bin/flight_parts
  cat << 'TEXT'

## Environment steps
`build/bin/environment_steps`: environments that a learner trains in, without the learner: a random policy, flights of 100 steps,
each over a world of its own. Worlds are included; of the radio only the heights that are flown are computed. Seconds are CPU time
of the threads, so two threads are as fast on two cores that do nothing else.
TEXT
  $bin/environment_steps | code

  say "environments in Python ..."
  cat << 'TEXT'

`bench/python_environments.py`: the same in Python, a random policy that steps 64 environments, worlds included, beside CartPole of Gymnasium in its
`SyncVectorEnv`, and in EnvPool (0.8.4 was measured) where that is installed. In turns, the best turn of each.
TEXT
  PYTHONPATH=build/python:${PYTHONPATH:-} build/python-venv/bin/python bench/python_environments.py 2> /dev/null | code

  say "a condition over DDS ..."
  cat << 'TEXT'

## Where the time of a condition goes
`aloft run data/experiments/quick.json` with one worker: ten agents, four conditions, 5 trials each, 200 flights.
The learning agent trains (and talks), the channel makes the SE tables and flies, the environment makes the cities.

| process | CPU s | share | peak MB |
|---|---|---|---|
TEXT
  profile condition run data/experiments/quick.json --trials 5 --workers 1 | whole_names
  cat << 'TEXT'

The four processes of a worker share most of their memory, the libraries; the sum of their peaks counts those four times.
TEXT

  say "the whole paper ..."
  cat << 'TEXT'

## The whole paper
`aloft reproduce` with two workers: eight agents on the cities of all five conditions, 100 trials each, 4,000 flights, and the
report.

| process | CPU s | share | peak MB |
|---|---|---|---|
TEXT
  profile paper reproduce --workers 2 | whole_names

  say "start and memory ..."
  cat << 'TEXT'

## Start and memory
`bench/start.sh`: four workers, that is 19 processes that find each other, from the command to the first flight in the
database; and what one worker takes while it flies eight agents (PSS: shared pages count by their share).
TEXT
  bench/start.sh 4 5 "$domain" | code
  cat << 'TEXT'

The whole of such a run, with one short flight for each worker, up to its table:

| process | CPU s | share | peak MB |
|---|---|---|---|
TEXT
  profile start run data/experiments/quick.json --trials 1 --agents min-height --workers 4 | whole_names

  say "scaling ..."
  cat << 'TEXT'

## Scaling
`build/bin/scaling`: flights per second of `aloft run` with one worker and all other processes on one core, and with two
workers on two cores, in turns (in brackets: every turn's ratio). `aloft run` keeps each of its workers on an equal share
of the cores: waking a process on another core costs more than most answers.
TEXT
  (cd build && bin/scaling "$domain") | code

  say "idling ..."
  cat << 'TEXT'

## Doing nothing
`bench/idle.sh`: CPU of processes with nothing to fly. Most of it is middleware: every process tells every other one twice
a second that it is there, so it grows with the processes in a domain.
TEXT
  bench/idle.sh 2 20 "$domain" | code

  say "coordinator ..."
  cat << 'TEXT'

## Growth of the coordinator
`build/bin/coordinator_benchmark`: coordinator and database without a bus; all workers are simulated and fly in no time, one
flight of 100 steps per trial, 64 per durable commit. CPU us, wall us and bytes per trial must not grow with the trials.
Restart: opening (SQLite checks the whole database) and reading it, when all flights are there.
TEXT
  (cd build && bin/coordinator_benchmark) | code
  echo
  echo "The same over DDS with the real coordinator and collector (\`build/bin/fake_workers\`); with few workers, the collector's"
  echo "commits every 50 ms are the limit:"
  (cd build && bin/fake_workers) | code

  say "bus ..."
  cat << 'TEXT'

## Bus
Steps per second of a worker whose agents do not learn, over DDS, the coordinator and the collector simulated by the
benchmark; and a report with its command, there and back, through our bus and with bare Fast DDS in turns.
TEXT
  { $bin/bus_worker --benchmark_format=csv 2> /dev/null | awk -F, '/^name/ {next} /^"worker/ {gsub(/"/, "", $1); split($1, n, "/"); printf "%-18s %8.0f steps/s\n", n[1], $NF}'
    $bin/bus_round_trip 2> /dev/null | grep -o '[a-z0-9_]*=[0-9.a-z]*' | sed 's/=/ /' | awk '{printf "%-18s %8s\n", $1, $2}'; } | code

  say "an agent in Python ..."
  cat << 'TEXT'

## An agent in Python
`bench/python_agent.py`: commands per second of an agent in Python (`aloft.dds`) that flies all flights of one worker, and the
CPU time that one command takes in its process, nearly all of it for reading the report.
TEXT
  PYTHONPATH=build/python build/python-venv/bin/python bench/python_agent.py "$domain" | code

  say "growth of the SE table ..."
  cat << 'TEXT'

## Growth of the SE table
101 points x 201 heights; us per base station must not grow.

| base stations per km2, window 3 km | stations | ms | us per station |
|---|---|---|---|
TEXT
  growth se_table_by_bs_density
  growth se_table_largest
  cat << 'TEXT'

| buildings per km2 (5 base stations) | stations | ms | us per station |
|---|---|---|---|
TEXT
  growth se_table_by_building_density
  cat << 'TEXT'

| window m (5 base stations per km2) | stations | ms | us per station |
|---|---|---|---|
TEXT
  growth se_table_by_window
  cat << 'TEXT'

## Regressions
`tools/instruction_count.sh` counts the instructions of fixed pieces of work with callgrind and compares them with
`bench/instruction_counts.json`: more than 5 % off fails. It is as good on a busy machine as on a quiet one, but counts the
AVX2 kernels only, and instructions are not time: look at the ratios above too.
TEXT
}

write > "$scratch/performance.md"
mv "$scratch/performance.md" "$out"
say "wrote $out"
