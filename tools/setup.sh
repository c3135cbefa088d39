#!/usr/bin/env bash
# Installs the Debian packages that Aloft needs and builds it into build/ (programs in build/bin/).
# Safe to repeat: with nothing to do it takes a second, and what an earlier call has added stays.
#   tools/setup.sh                     the programs
#   tools/setup.sh --for flight        the programs without the charts of `aloft report`: a third of the packages
#   tools/setup.sh --for tests         programs, tests and benchmarks
#   tools/setup.sh --for integration   likewise, and installs what only integration tests need
#   tools/setup.sh --for lint          likewise, and installs what only tools/lint.sh needs
#   tools/setup.sh --for fuzz          likewise, and installs what only tools/fuzz.sh needs
#   tools/setup.sh --for packages      the programs and the Python package, and installs what only cpack needs
#   tools/setup.sh --for python        only installs what `pip install ./python` needs
#   tools/setup.sh ... --install       only installs
#   tools/setup.sh ... release | asan | tsan | fuzz [TARGET ...]    the kind of build; the targets to build, instead of all
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
refuse() { echo "tools/setup.sh: $*" >&2; exit 2; }

declare -A groups_for=(
  [flight]="core flight"
  [programs]="core flight report"
  [tests]="core flight report python tests"
  [integration]="core flight report python tests integration"
  [lint]="core flight report python tests lint"
  [fuzz]="core flight report python tests fuzz"
  [packages]="core flight report python packages"
  [python]="core python"
)
purpose=programs
install_only=""
while [ $# -gt 0 ]; do
  case "$1" in
    --for)
      purpose=${2:-}
      [ -n "${groups_for[${purpose:-none}]:-}" ] || refuse "--for '$purpose' is unknown; use flight, programs, tests, integration, lint, fuzz, packages or python"
      shift 2
      ;;
    --install) install_only=yes; shift ;;
    *) break ;;
  esac
done
[ "$purpose" != python ] || install_only=yes
preset=${1:-release}
[ $# -eq 0 ] || shift
case "$preset" in
  release | asan | tsan | fuzz) ;;
  *) refuse "unknown preset '$preset'; use release, asan, tsan or fuzz" ;;
esac
groups=" ${groups_for[$purpose]} "

# What the machine calls itself, e.g. "debian 12".
system=$(. /etc/os-release && echo "${ID:-unknown} ${VERSION_ID:-without a version}")
case "$system" in
  "debian 12" | "debian 13") release=${system#debian } ;;
  *) refuse "this machine runs '$system'; supported are Debian 12 and Debian 13" ;;
esac

packages=()
while read -r line; do
  case "$line" in
    "" | "#"*) continue ;;
    "["*) group=${line:1:-1}; continue ;;
    [0-9]*) of_release=${line%%: *} ;;
    *) of_release=$release ;;
  esac
  [[ $groups != *" $group "* || $of_release != "$release" ]] || packages+=("${line#*: }")
done < tools/packages.txt

missing=()
installed=" $(dpkg-query -W -f '${Package}=${db:Status-Status} ' "${packages[@]}" 2> /dev/null || true)"
# On some machines these come from another source than Debian; having the command is enough.
declare -A command_of=([nodejs]=node [npm]=npm [chromium]=chromium)
for package in "${packages[@]}"; do
  command -v "${command_of[$package]:-none}" > /dev/null || [[ $installed == *" $package=installed "* ]] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "Installing ${#missing[@]} Debian packages and what they need: ${missing[*]}"
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo > /dev/null || refuse "run as root, or install sudo, to add packages: ${missing[*]}"
    as_root=(sudo)
  fi
  apt_get=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300)
  "${apt_get[@]}" update
  "${apt_get[@]}" install -y --no-install-recommends "${missing[@]}"
fi
[ -z "$install_only" ] || exit 0

folder=build
[ "$preset" = release ] || folder=build-$preset
configure=()
# Instrumented code is not loaded into Python.
[ "$preset" = release ] || groups=${groups/ python / }
[[ $groups != *" python "* ]] || tools/python_environment.sh "$folder/python-venv"
for option in ALOFT_REPORT_CHARTS:report ALOFT_PYTHON:python ALOFT_TESTS:tests ALOFT_BENCHMARKS:tests; do
  name=${option%:*}
  if [[ $groups == *" ${option#*:} "* ]]; then wanted=ON; else wanted=OFF; fi
  had=$(sed -n "s/^$name:BOOL=//p" "$folder/CMakeCache.txt" 2> /dev/null || true)
  [ "$had" = ON ] || [ "$had" = "$wanted" ] || configure+=("-D$name=$wanted")
done
# What is built for the tests of another middleware alone is built once, on a release whose compiler is not the one that
# judges: libraries and programs in one translation unit each take half the time.
[ "${1:-}" != tests_middleware ] || configure+=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0)
export CCACHE_NOHASHDIR=1 CCACHE_BASEDIR=$PWD CCACHE_SLOPPINESS=pch_defines,time_macros
[ -f "$folder/build.ninja" ] && [ ${#configure[@]} -eq 0 ] || cmake --preset "$preset" "${configure[@]}"
# In a folder that also has tests, the programs alone.
[ $# -gt 0 ] || [[ $groups == *" tests "* ]] || set -- programs
cmake --build "$folder" ${1:+--target} "$@"
