#!/usr/bin/env bash
# Checks deploy/k8s against the schemas of the Kubernetes API. Usage: kubernetes_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source_folder=$1
build_folder=$2

# The schemas, exactly as the lock file has them.
lock=$source_folder/tests/deploy/package-lock.json
if ! cmp -s "$lock" "$build_folder/node_modules/.installed"; then
  cp "$source_folder/tests/deploy/package.json" "$lock" "$source_folder/tools/report/.npmrc" "$build_folder/"
  if ! (cd "$build_folder" && npm ci --ignore-scripts --no-progress --loglevel=error) 2> "$build_folder/npm.log"; then
    cat "$build_folder/npm.log"
    # Without a network the check is skipped; any other failure of npm is a failure of the test.
    grep -qE 'ENOTFOUND|EAI_AGAIN|ENETUNREACH|EHOSTUNREACH|ECONNREFUSED|ETIMEDOUT' "$build_folder/npm.log" || exit 1
    echo "SKIPPED: the check of aloft.yaml: npm cannot fetch the schemas of the Kubernetes API"
    exit 77
  fi
  cp "$lock" "$build_folder/node_modules/.installed"
fi
node "$source_folder/tests/deploy/kubernetes_test.mjs" "$build_folder/node_modules" "$source_folder/deploy/k8s/aloft.yaml"
