#!/usr/bin/env bash
# Checks deploy/k8s against the schemas of the Kubernetes API. Usage: kubernetes_test.sh SOURCE_FOLDER FOLDER_OF_SCHEMAS
set -euo pipefail
source_folder=$1
folder=$2
if ! cmp -s "$source_folder/tests/deploy/package-lock.json" "$folder/node_modules/.installed"; then
  echo "SKIPPED: the check of aloft.yaml: the build had no npm, or no network, to fetch the schemas of the Kubernetes API; build again with both"
  exit 77
fi
node "$source_folder/tests/deploy/kubernetes_test.mjs" "$folder/node_modules" "$source_folder/deploy/k8s/aloft.yaml"
