#!/usr/bin/env bash
# Fetches the schemas of the Kubernetes API, exactly as the lock file has them, when the tests are built: they may run
# without a network. Without one, or without npm, nothing is fetched, and the test is skipped. Usage: kubernetes_schemas.sh SOURCE_FOLDER FOLDER
set -euo pipefail
source_folder=$1
folder=$2
lock=$source_folder/tests/deploy/package-lock.json
! cmp -s "$lock" "$folder/node_modules/.installed" || exit 0
command -v npm > /dev/null || exit 0
cp "$source_folder/tests/deploy/package.json" "$lock" "$source_folder/tools/report/.npmrc" "$folder/"
if (cd "$folder" && npm ci --ignore-scripts --no-progress --fetch-retries=1 --loglevel=error) 2> "$folder/npm.log"; then
  cp "$lock" "$folder/node_modules/.installed"
else
  cat "$folder/npm.log" >&2
  # Any other failure of npm fails the build.
  grep -qE 'ENOTFOUND|EAI_AGAIN|ENETUNREACH|EHOSTUNREACH|ECONNREFUSED|ETIMEDOUT' "$folder/npm.log"
fi
