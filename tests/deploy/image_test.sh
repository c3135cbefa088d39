#!/usr/bin/env bash
# Checks that deploy/compose/Dockerfile installs exactly the libraries that the programs need on this release.
# Usage: image_test.sh SOURCE_FOLDER BIN_FOLDER
set -euo pipefail
dockerfile=$1/deploy/compose/Dockerfile
bin=$2
. /etc/os-release
installed=$(tr -d '\\\n' < "$dockerfile" | sed -nE "s/.*&& $VERSION_CODENAME=\"([^\"]*)\".*/\1/p" | tr -s ' ' '\n' | sort)
[ -n "$installed" ] || { echo "$dockerfile has no libraries for $VERSION_CODENAME"; exit 1; }

programs=$(grep -oE '/aloft/build/bin/aloft[a-z-]*' "$dockerfile" | sed "s|/aloft/build/bin|$bin|")
# Shared objects by name, then the packages that they are from. Every image has the last three.
needed=$(for program in $programs; do objdump -p "$program"; done | awk '$1 == "NEEDED" { print $2 }' | sort -u \
  | while read -r name; do dpkg-query --search "*-linux-gnu/$name" | cut -d: -f1; done | sort -u | grep -vxE 'libc6|libgcc-s1|libstdc\+\+6')
if [ "$installed" != "$needed" ]; then
  echo "deploy/compose/Dockerfile, $VERSION_CODENAME: < installed, > needed by the programs"
  diff <(echo "$installed") <(echo "$needed")
  exit 1
fi
echo "deploy/compose/Dockerfile installs the libraries of the programs on $VERSION_CODENAME"
