"""A flight in Python has the bytes of the one that the C++ host stores."""

import csv
import hashlib
import json
import sqlite3
import subprocess
from pathlib import Path

import numpy as np
from conftest import SAMPLE

import aloft

TRIALS = 100
EXPERIMENT = {
    "name": "digest",
    "seed": 9,
    "trials": TRIALS,
    "energy_weight": 0.002,
    "handover_cost": 0.25,
    "agents": ["random-walk"],
    "worlds": [
        {"name": "generated", "kind": "generated", "height_resolution_m": 10},
        {"name": "serving", "route": "serving", "preset": "paper-text", "height_resolution_m": 10},
        {"name": "measured", "kind": "measured", "file": SAMPLE},
    ],
}
COMMANDS = {"down": 0, "hold": 1, "up": 2}


def test_flights_of_python_and_of_the_host_are_the_same_bytes(aloft_program: str, tmp_path: Path) -> None:
    file, results = tmp_path / "digest.json", tmp_path / "results"
    file.write_text(json.dumps(EXPERIMENT))
    subprocess.run([aloft_program, "run", file, "--in-process", "--out", results], check=True, capture_output=True)
    export = [aloft_program, "export", results, "--steps", "--format", "csv"]
    steps = csv.DictReader(subprocess.run(export, check=True, capture_output=True, text=True).stdout.splitlines())
    commands: dict[tuple[str, int], list[int]] = {}
    for step in steps:
        commands.setdefault((step["condition"], int(step["trial"])), []).append(COMMANDS[step["action"]])
    database = sqlite3.connect(results / "results.sqlite")
    stored = database.execute(
        "SELECT condition, trial, digest, bytes FROM flight JOIN trace ON trace.flight = flight.id"
    ).fetchall()
    database.close()
    assert len(stored) == len(commands) == TRIALS * len(EXPERIMENT["worlds"])

    env = aloft.HeightEnv(file)
    for condition, trial, digest, expected in stored:
        env.reset(seed=9, options={"trial": trial, "condition": condition})
        flown = [env.step(action) for action in commands[env.conditions[condition], trial]]
        assert flown[-1][2]
        trace = env.trace("random-walk")
        assert trace == expected
        assert hashlib.sha256(trace).hexdigest() == digest

    envs = aloft.HeightVectorEnv(TRIALS, file, autoreset_mode="Disabled")
    for condition, name in enumerate(envs.conditions):
        envs.reset(seed=[9] * TRIALS, options={"trial": np.arange(TRIALS), "condition": condition})
        for actions in zip(*(commands[name, trial] for trial in range(TRIALS)), strict=True):
            envs.step(np.array(actions))
        for at, trial, digest, _ in stored:
            if at == condition:
                assert hashlib.sha256(envs.trace(trial, "random-walk")).hexdigest() == digest
