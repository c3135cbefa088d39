#!/usr/bin/env bash
# Makes FOLDER a virtual environment of Debian's Python with what building and testing the Python package needs, in the
# versions of python/tests/requirements.txt. With nothing to do it takes no time. Of Debian's own packages it sees PyTorch, pandas and
# the NumPy for which that was built.
#   tools/python_environment.sh FOLDER
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:?tools/python_environment.sh: name the folder}
python=/usr/bin/python3  # not another one of PATH: Debian's, for which its packages are built
made_from="$("$python" --version) $(sha256sum python/tests/requirements.txt)"
[ "$(cat "$folder/made-from" 2> /dev/null || true)" != "$made_from" ] || exit 0
echo "Making $folder: Python packages from PyPI"
rm -rf "$folder"
"$python" -m venv --system-site-packages "$folder"
# Pins name all that is needed, so that Stable-Baselines3 brings no second PyTorch.
"$folder/bin/pip" install --quiet --disable-pip-version-check --no-deps --only-binary :all: -r python/tests/requirements.txt
echo "$made_from" > "$folder/made-from"
