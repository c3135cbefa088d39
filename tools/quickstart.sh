#!/usr/bin/env bash
# From a fresh clone to the first comparison: installs, builds, flies data/experiments/quick.json, prints the table.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh
exec build/bin/aloft run data/experiments/quick.json "$@"
