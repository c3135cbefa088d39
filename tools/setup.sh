#!/usr/bin/env bash
# Installs every Debian package that Aloft needs and builds it into build/ (programs in build/bin/).
# Safe to repeat: with nothing to do it takes a second.
#   tools/setup.sh [release | asan | tsan [TARGET ...]]    the targets to build, instead of all
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
[ $# -eq 0 ] || shift
case "$preset" in
  release | asan | tsan) ;;
  *)
    echo "tools/setup.sh: unknown preset '$preset'; use release, asan or tsan" >&2
    exit 2
    ;;
esac

mapfile -t packages < <(grep -v '^#' tools/packages.txt)
missing=()
# On some machines these come from another source than Debian; having the command is enough.
declare -A command_of=([nodejs]=node [npm]=npm [chromium]=chromium)
for package in "${packages[@]}"; do
  command -v "${command_of[$package]:-none}" >/dev/null && continue
  [ "$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null)" = "install ok installed" ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "tools/setup.sh: run as root, or install sudo, to add packages: ${missing[*]}" >&2; exit 2; }
    as_root=(sudo)
  fi
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}"
fi

export CCACHE_NOHASHDIR=1 CCACHE_BASEDIR=$PWD CCACHE_SLOPPINESS=pch_defines,time_macros
folder=build
[ "$preset" = release ] || folder=build-$preset
[ -f "$folder/build.ninja" ] || cmake --preset "$preset"
cmake --build "$folder" ${1:+--target} "$@"
