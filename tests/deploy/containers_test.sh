#!/usr/bin/env bash
# Checks deploy/compose and deploy/k8s against their schemas. Usage: containers_test.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source_folder=$1
build_folder=$2
docker-compose --file "$source_folder/deploy/compose/compose.yaml" config --quiet
echo "compose.yaml is valid"

# The schemas of the Kubernetes API, exactly as the lock file has them.
lock=$source_folder/tests/deploy/package-lock.json
if ! cmp -s "$lock" "$build_folder/node_modules/.installed"; then
  cp "$source_folder/tests/deploy/package.json" "$lock" "$source_folder/tools/report/.npmrc" "$build_folder/"
  (cd "$build_folder" && npm ci --ignore-scripts --no-progress --loglevel=error)
  cp "$lock" "$build_folder/node_modules/.installed"
fi
node "$source_folder/tests/deploy/kubernetes_test.mjs" "$build_folder/node_modules" "$source_folder/deploy/k8s/aloft.yaml"
