#!/usr/bin/env bash
# Makes the Debian packages on a release of Debian and tries them in a fresh root of it (tests/install/packages.sh). Needs
# root, debootstrap and apt's mirror. The packages are left in build-packages/RELEASE/.
#   tools/package_check.sh [debian12 | debian13]    [this machine's]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
name=${1:-debian$(. /etc/os-release && echo "$VERSION_ID")}
packages=build-packages/$name
tools/on_debian.sh "$name" --for packages --online tools/setup.sh --for packages  # refuses a release that it does not know
rm -rf "$packages"
mkdir -p "$packages"
tools/on_debian.sh "$name" --for packages cpack --config build/CPackConfig.cmake -B "$packages"
rm -rf "$packages/_CPack_Packages"
[ "$(ls "$packages")" = "$(cd "$packages" && ls -d aloft_*.deb aloft-dev_*.deb python3-aloft_*.deb)" ] ||
  { echo "tools/package_check.sh: not the packages aloft, aloft-dev and python3-aloft: $(ls "$packages")" >&2; exit 1; }
tools/on_debian.sh "$name" --fresh --online tests/install/packages.sh "$packages"
echo "The packages of $name pass: $packages/"
