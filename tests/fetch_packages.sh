#!/usr/bin/env bash
# Fetches the npm packages of some tests into FOLDER, exactly as the lock file in LOCK_FOLDER has them, when the tests are
# built: they may run without a network. Without one, or without npm, nothing is fetched, and the tests are skipped.
# Usage: fetch_packages.sh LOCK_FOLDER FOLDER
set -euo pipefail
lock_folder=$1
folder=$2
npmrc=$(dirname "${BASH_SOURCE[0]}")/../tools/report/.npmrc
lock=$lock_folder/package-lock.json
! cmp -s "$lock" "$folder/node_modules/.installed" || exit 0
command -v npm > /dev/null || exit 0
cp "$lock_folder/package.json" "$lock" "$npmrc" "$folder/"
if (cd "$folder" && npm ci --ignore-scripts --no-progress --fetch-retries=1 --loglevel=error) 2> "$folder/npm.log"; then
  cp "$lock" "$folder/node_modules/.installed"
else
  cat "$folder/npm.log" >&2
  # Any other failure of npm fails the build.
  grep -qE 'ENOTFOUND|EAI_AGAIN|ENETUNREACH|EHOSTUNREACH|ECONNREFUSED|ETIMEDOUT' "$folder/npm.log"
fi
