#!/usr/bin/env bash
# Tries the Debian packages in FOLDER on a machine that has never seen Aloft, as root: installs them, flies the quick
# experiment as an ordinary user, builds the example of aloft-dev and flies it, flies in Python with Gymnasium from PyPI, removes
# all of it, and compares the files before and after. It installs packages and makes a user: for a machine that is thrown away (tools/package_check.sh).
#   tests/install/packages.sh FOLDER
set -euo pipefail
checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
cd "$1"
export DEBIAN_FRONTEND=noninteractive LANG=C.UTF-8
work=$(mktemp -d)
chmod 755 "$work"
quietly() { "$@" > "$work/log" 2>&1 || { cat "$work/log"; echo "failed: $*"; exit 1; } >&2; }
# What dpkg and apt keep about packages that they have removed is theirs.
files() { find / -xdev \( -path "$checkout" -o -path "$work" -o -path /var/lib/dpkg -o -path /var/lib/apt -o -path /var/cache -o -path /var/log -o -path /home \
  -o -name '*.pyc' \) -prune -o ! -type d -print | sort; }
quietly apt-get -q update
quietly apt-get -q install -y --no-install-recommends g++ cmake make python3-venv  # what builds the example: there before and after
quietly useradd --create-home flyer
ldconfig
files > "$work/before"
as_flyer() { setpriv --reuid flyer --regid flyer --init-groups env -i HOME=/home/flyer PATH=/usr/bin:/bin LANG=C.UTF-8 bash -ec "cd; $1"; }

quietly apt-get -q install -y --no-install-recommends ./aloft_*.deb
as_flyer 'aloft --version && aloft run quick --out quick && aloft digest quick'
as_flyer 'aloft run quick --in-process --out again > log && aloft compare quick again --exact | tail -n 1'
quietly apt-get -q install -y --no-install-recommends ./aloft-dev_*.deb
as_flyer 'cp -r /usr/share/doc/aloft/examples/agent .
  { cmake -S agent -B built && cmake --build built; } > log || { cat log; exit 1; }
  aloft agents --plugin built/libpatient_climber.so --check patient-climber
  aloft run quick --plugin built/libpatient_climber.so --agents min-height,patient-climber --trials 2 --out mine'
quietly apt-get -q install -y --no-install-recommends ./python3-aloft_*.deb
as_flyer 'python3 -c "import aloft; aloft.HeightEnv" 2>&1 | grep "pip install gymnasium"
  python3 -m venv --system-site-packages with-gymnasium > log
  with-gymnasium/bin/pip install --quiet gymnasium > log || { cat log; exit 1; }
  with-gymnasium/bin/python -c "
import gymnasium
env = gymnasium.make(\"aloft:Aloft/Height-v0\", world=\"/usr/share/aloft/experiments/quick.json\")
print(env.reset(seed=1)[1], env.step(2)[1])"'
quietly apt-get -q purge -y --autoremove aloft aloft-dev python3-aloft
files > "$work/after"
diff "$work/before" "$work/after"
echo "the packages are removed without a trace"
