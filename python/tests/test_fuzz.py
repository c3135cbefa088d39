import os
import re
import subprocess
import sys
from pathlib import Path


def test_nothing_crashes_whatever_is_passed() -> None:
    """ALOFT_FUZZ_SECONDS=600 looks for what a short run does not meet."""
    seconds = os.environ.get("ALOFT_FUZZ_SECONDS", "5")
    script = Path(__file__).with_name("fuzz_binding.py")
    done = subprocess.run(
        [sys.executable, script, "--seconds", seconds], capture_output=True, text=True, errors="replace"
    )
    assert done.returncode == 0, done.stderr[-5000:]
    counts = re.search(r"(\d+) rounds, (\d+) calls, (\d+) of them accepted", done.stdout)
    assert counts is not None, done.stdout
    rounds, calls, accepted = map(int, counts.groups())
    assert rounds >= 200 and calls > accepted > calls / 10
