#!/usr/bin/env bash
# From a fresh clone to the first comparison: installs, builds, flies data/experiments/quick.json, prints the table. Only
# what that needs; tools/setup.sh adds the charts of `aloft report`, tools/test.sh the tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools/setup.sh --for flight
exec build/bin/aloft run data/experiments/quick.json "$@"
