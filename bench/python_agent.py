#!/usr/bin/env python3
"""Commands per second of an agent in Python that flies all flights of a worker, and what a command costs it.

    PYTHONPATH=build/python build/python-venv/bin/python bench/python_agent.py [DOMAIN]

The flights are long and their world is made quickly, so the time is that of the bus, the channel and the agent. It counts
from the first command to the last.
"""

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from aloft.dds import Action, Agent

FLIGHTS, STEPS = 10, 5000
EXPERIMENT = {
    "name": "python-agent",
    "trials": FLIGHTS,
    "agents": [{"type": "external", "name": "python"}],
    "world": {"bs_density_per_km2": 5, "window_m": 1000, "route_start_x_m": -400, "route_spacing_m": 0.1, "steps": STEPS},
}


class Counted(Agent):
    """The least that an agent can do, with the times of its commands."""

    def __init__(self):
        self.wall_s, self.cpu_s = [], []

    def act(self, report):
        self.wall_s.append(time.monotonic())
        self.cpu_s.append(time.process_time())
        return Action.ACTION_HOLD


def main():
    domain, run = int(sys.argv[1]) if len(sys.argv) > 1 else 59, f"python-agent-{os.getpid()}"
    programs = Path(os.environ.get("ALOFT_BIN", Path(__file__).parents[1] / "build/bin"))
    agent = Counted()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "experiment.json")
        file.write_text(json.dumps(EXPERIMENT))
        place = ["--run", run, "--domain", str(domain), "--workers", "1", "--out", Path(folder, "out")]
        flown = subprocess.Popen([programs / "aloft", "run", file, *place], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        threading.Thread(target=lambda: (flown.wait(), agent.stop())).start()
        agent.run(domain, run, "w0", "python")
    if flown.returncode != 0 or len(agent.wall_s) < FLIGHTS * STEPS:
        sys.exit(f"aloft run ended with code {flown.returncode} after {len(agent.wall_s)} commands")
    rate = (len(agent.wall_s) - 1) / (agent.wall_s[-1] - agent.wall_s[0])
    cost_us = 1e6 * (agent.cpu_s[-1] - agent.cpu_s[0]) / (len(agent.cpu_s) - 1)
    print(f"python_agent       {rate:8.0f} commands/s\npython_cpu_us      {cost_us:8.1f}")


main()
