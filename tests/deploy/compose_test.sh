#!/usr/bin/env bash
# Checks deploy/compose against the schema of docker-compose. Usage: compose_test.sh SOURCE_FOLDER
set -euo pipefail
source_folder=$1
command -v docker-compose > /dev/null || { echo "SKIPPED: the check of compose.yaml: there is no docker-compose"; exit 77; }
docker-compose --file "$source_folder/deploy/compose/compose.yaml" config --quiet
echo "compose.yaml is valid"
