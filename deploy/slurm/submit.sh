#!/usr/bin/env bash
# Runs an experiment on a Slurm cluster: one job that coordinates and stores, and an array of workers.
#   deploy/slurm/submit.sh EXPERIMENT OUT WORKERS [sbatch options for all, e.g. --partition=short --time=12:00:00]
# OUT, the experiment and the build must be on a file system that all nodes share. The same command continues an
# interrupted run. Environment:
#   ALOFT             the program [build/bin/aloft beside this script]
#   ALOFT_INTERFACE   network interface between the nodes, by name or address [the node's first address]
set -euo pipefail
if [ $# -lt 3 ] || ! [[ $3 =~ ^[1-9][0-9]*$ ]]; then sed -n '2,7p' "$0" >&2; exit 2; fi
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
ALOFT=$(realpath "${ALOFT:-$here/../../build/bin/aloft}")
ALOFT_EXPERIMENT=$(realpath "$1")
ALOFT_OUT=$(realpath -m "$2")
workers=$3
shift 3
export ALOFT ALOFT_EXPERIMENT ALOFT_OUT

"$ALOFT" validate "$ALOFT_EXPERIMENT" >&2
mkdir -p "$ALOFT_OUT/log"
log=$ALOFT_OUT/log/slurm-%x-%j.log
ALOFT_COORDINATOR_JOB=$(sbatch --parsable --output="$log" "$@" "$here/coordinator.sbatch")
export ALOFT_COORDINATOR_JOB
array=$(sbatch --parsable --output="$log" --dependency="after:$ALOFT_COORDINATOR_JOB" --array="1-$workers" "$@" "$here/worker.sbatch")
echo "coordinator: job $ALOFT_COORDINATOR_JOB, workers: job $array, results: $ALOFT_OUT, logs: $ALOFT_OUT/log" >&2
echo "$ALOFT_COORDINATOR_JOB $array"
