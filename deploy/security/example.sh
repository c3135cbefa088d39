#!/usr/bin/env bash
# Makes an authority and keys in a scratch folder, flies a small secured run, and shows that an observer without keys receives nothing.
#   PATH=build/bin:$PATH deploy/security/example.sh
set -euo pipefail
experiment=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/data/experiments/quick.json
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
domain=${ALOFT_DOMAIN:-0}

aloft keys init "$scratch/keys"
aloft keys issue "$scratch/keys" all --days 1
aloft doctor --secure "$scratch/keys" --domain "$domain" --out "$scratch"

aloft run "$experiment" --agents min-height,planner --trials 20 --workers 1 --domain "$domain" \
  --run example --secure "$scratch/keys" --out "$scratch/secured" &
sleep 2
echo "An observer with keys:" && aloft status --run example --domain "$domain" --secure "$scratch/keys" || true
echo "An observer without:" && aloft status --run example --domain "$domain" --wait 2 || true
wait
aloft run "$experiment" --agents min-height,planner --trials 20 --in-process --out "$scratch/open" > /dev/null
[ "$(aloft digest "$scratch/secured")" = "$(aloft digest "$scratch/open")" ] && echo "The same bytes, secured or not."
