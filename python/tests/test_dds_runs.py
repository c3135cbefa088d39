"""Agents in Python in real runs: the programs in ALOFT_BIN, over DDS."""

import csv
import hashlib
import io
import itertools
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import aloft
import numpy as np
from conftest import SAMPLE
from flying_agents import Climber, Zigzag

pytestmark = pytest.mark.runs

SOURCE = Path(__file__).resolve().parents[2]
PROGRAMS = Path(os.environ.get("ALOFT_BIN", SOURCE / "build/bin"))
LIMIT_S = 120.0  # for what takes seconds on an idle machine

WORLD = {"kind": "generated", "bs_density_per_km2": 5}
# Long flights through a world that is made quickly, so that the agents can be swapped in mid-flight.
LONG = {"bs_density_per_km2": 5, "window_m": 1000, "route_start_x_m": -400, "route_spacing_m": 0.1, "steps": 5000}
VISITOR = {"type": "external", "name": "visitor"}


class Scene:
    """A run of one worker, and the agents of the test that join it. Every wait has a limit and names whom it waits for."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.run = f"py-{os.getpid()}-{folder.name}"
        self.domain = str(10 + os.getpid() % 90)
        self.out = folder / "results"
        self.processes: dict[str, subprocess.Popen[str]] = {}

    def start(self, name: str, command: list[str | Path]) -> None:
        with (self.folder / f"{name}.log").open("a") as log:
            self.processes[name] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, text=True, cwd=SOURCE
            )

    def start_run(self, agents: list[Any], trials: int, worlds: list[dict[str, Any]] | None = None, **keys: Any) -> None:
        experiment = self.folder / "experiment.json"
        experiment.write_text(
            json.dumps({"name": "python", "seed": 5, "trials": trials, "worlds": worlds or [WORLD], "agents": agents, **keys})
        )
        options = ["--run", self.run, "--domain", self.domain, "--workers", "1", "--out", self.out]
        self.start("aloft", [PROGRAMS / "aloft", "run", experiment, *options])

    def start_agent(self, kind: str, *more: str | Path, name: str = "visitor") -> None:
        place = [self.domain, self.run, "w0", name]
        self.start(name, [sys.executable, Path(__file__).parent / "flying_agents.py", kind, *place, *more])

    def ended(self, name: str) -> int:
        try:
            return self.processes[name].wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            pytest.fail(f"{name} has not ended in {LIMIT_S:.0f} s.\n{self.said()}")

    def wait_for(self, what: str, is_there: Callable[[], bool]) -> None:
        end = time.monotonic() + LIMIT_S
        while not is_there():
            if time.monotonic() > end:
                pytest.fail(f"{what} was not there after {LIMIT_S:.0f} s.\n{self.said()}")
            time.sleep(0.02)

    def said(self) -> str:
        logs = [*self.folder.glob("*.log"), *self.out.glob("log/*.log")]
        return "\n".join(f"--- {log.name}\n{log.read_text()[-2000:]}" for log in logs)

    def channel_log(self) -> str:
        log = self.out / "log/aloft-channel-w0.log"
        return log.read_text() if log.exists() else ""

    def stop(self) -> None:
        for process in self.processes.values():
            process.kill()
            process.wait()

    def finish(self) -> None:
        """The run comes to its end; then its agents end when they are told to."""
        assert self.ended("aloft") == 0, self.said()
        for name, process in self.processes.items():
            if name != "aloft":
                process.send_signal(signal.SIGTERM)
                assert self.ended(name) == 0, self.said()

    def export(self, rows: str) -> list[dict[str, str]]:
        command = [PROGRAMS / "aloft", "export", rows, self.out]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        return list(csv.DictReader(io.StringIO(done.stdout)))

    def steps(self, agent: str) -> dict[int, list[dict[str, str]]]:
        """The steps of an agent's flights, by trial."""
        flights: dict[int, list[dict[str, str]]] = {}
        for step in self.export("--steps"):
            if step["agent"] == agent:
                flights.setdefault(int(step["trial"]), []).append(step)
        return flights


@pytest.fixture
def scene(tmp_path: Path) -> Iterator[Scene]:
    scene = Scene(tmp_path)
    yield scene
    scene.stop()


def numbers(step: dict[str, str], *columns: str) -> list[float]:
    return [float(step[column]) for column in columns]


def heights(steps: list[dict[str, str]]) -> list[float]:
    return [float(step["height_m"]) for step in steps]


def stairs(steps: int) -> list[float]:
    height_m, made = 40.0, []
    for step in range(steps):
        height_m = min(240.0, max(40.0, height_m + (10.0 if step % 6 < 4 else -10.0)))
        made.append(height_m)
    return made


def test_min_height_of_the_examples_flies_as_the_agent_of_that_name(scene: Scene) -> None:
    scene.start_run(["min-height", VISITOR], trials=200, energy_weight=0.001, handover_cost=0.5)
    program = SOURCE / "examples/python/min_height.py"
    scene.start("visitor", [sys.executable, program, scene.domain, scene.run, "w0", "visitor"])
    scene.finish()
    ours, theirs = scene.steps("min-height"), scene.steps("visitor")
    assert sorted(theirs) == list(range(200))
    same = ["step", "action", "x_m", "y_m", "height_m", "serving_cell", "serving_sinr_db", "qos", "reward", "energy_j"]
    for trial in theirs:
        assert [[step[column] for column in same] for step in theirs[trial]] == [
            [step[column] for column in same] for step in ours[trial]
        ]
    flights = {(row["agent"], row["trial"]): row for row in scene.export("--flights")}
    for trial in map(str, theirs):
        one, other = flights["min-height", trial], flights["visitor", trial]
        assert {key for key in one if one[key] != other[key]} == {"agent", "agent_type", "digest"}


@pytest.mark.parametrize("kind", ["climber", "stairs"])
def test_an_agent_that_is_killed_in_mid_flight_and_restarted_flies_the_same(scene: Scene, kind: str) -> None:
    scene.start_run([VISITOR], trials=10)
    scene.start_agent(f"mortal-{kind}", scene.folder / "killed")
    assert scene.ended("visitor") == -signal.SIGKILL, scene.said()
    scene.start_agent(f"mortal-{kind}", scene.folder / "killed")
    scene.finish()
    flights = scene.steps("visitor")
    assert sorted(flights) == list(range(10))
    expected = stairs(100) if kind == "stairs" else [min(240.0, 50.0 + 10.0 * step) for step in range(100)]
    assert all(heights(steps) == expected for steps in flights.values())
    began_again = "agent visitor has no history of its flight" in scene.channel_log()
    assert began_again == (kind == "stairs")


def test_an_agent_relieves_and_is_relieved_by_agents_in_cpp(scene: Scene) -> None:
    crew = [
        {"agent": "min-height"},
        {"agent": VISITOR, "from_step": 31, "shadow": False},
        {"agent": "constant-120", "from_step": 61, "shadow": False},
    ]
    scene.start_run([{"type": "relay", "name": "uav", "crew": crew}], trials=10)
    scene.start_agent("climber")
    scene.finish()
    flights = scene.steps("uav")
    assert sorted(flights) == list(range(10))
    for steps in flights.values():
        pilots = [step["flown_by"] for step in steps]
        assert pilots == ["min-height"] * 30 + ["visitor"] * 30 + ["constant-120"] * 40
        assert heights(steps)[:60] == [40.0] * 30 + [min(240.0, 50.0 + 10.0 * step) for step in range(30)]
        assert heights(steps)[-1] == 120.0


def test_a_policy_observes_in_a_run_what_it_observes_in_the_environment(scene: Scene) -> None:
    worlds = [{**WORLD, "site_map_error_m": 30, "site_map_route_points": [0, 4]}, {"kind": "measured", "file": SAMPLE}]
    scene.start_run([{**VISITOR, "privilege": "site-map"}], 2, worlds, energy_weight=0.001, handover_cost=0.5)
    scene.start_agent("recorder", scene.folder)
    scene.finish()
    env = aloft.HeightEnv(scene.folder / "experiment.json", history=2, site_map=3)
    digests = {(row["condition"], row["trial"]): row["digest"] for row in scene.export("--flights")}
    assert len(digests) == 6
    for (condition, name), trial in itertools.product(enumerate(env.conditions), range(2)):
        observation, info = env.reset(seed=5, options={"condition": condition, "trial": trial})
        seen = np.load(scene.folder / f"{condition}-{trial}.npy")
        assert len(seen) == info["steps"]
        policy = Zigzag()
        for step in range(info["steps"]):
            np.testing.assert_array_equal(seen[step], observation)
            observation, *_ = env.step(np.int64(policy.predict(observation)[0]))
        assert hashlib.sha256(env.trace("visitor")).hexdigest() == digests[name, str(trial)]


def test_an_agent_can_be_run_again_in_the_same_process() -> None:
    agent = Climber()
    for _ in range(2):
        timer = threading.Timer(0.3, agent.stop)
        timer.start()
        agent.run(10 + os.getpid() % 90, f"py-{os.getpid()}", "w0", "visitor")
        timer.join()


def test_an_agent_is_swapped_in_and_out_by_order_in_mid_flight(scene: Scene) -> None:
    crew = [{"agent": "min-height"}, {"agent": VISITOR, "shadow": False}]
    agents = [{"type": "relay", "name": "uav", "crew": crew}]
    scene.start_run(agents, trials=8, worlds=[LONG], on_agent_loss="failover")
    scene.start_agent("climber")
    scene.wait_for("agent visitor", lambda: "agent visitor is there" in scene.channel_log())
    place = ["--run", scene.run, "--worker", "w0", "--domain", scene.domain]
    for pilot in ("visitor", "min-height", "visitor", "min-height"):
        order = [PROGRAMS / "aloft", "swap", *place, "--agent", pilot, "--limit", f"{LIMIT_S:.0f}"]
        done = subprocess.run(order, capture_output=True, text=True, timeout=2 * LIMIT_S, check=False)
        assert done.returncode == 0, done.stderr + scene.said()
    scene.finish()
    flights = scene.steps("uav").values()
    assert all([int(step["step"]) for step in steps] == list(range(1, 5001)) for steps in flights)
    turns = [[pilot for pilot, _ in itertools.groupby(step["flown_by"] for step in steps)] for steps in flights]
    assert max(map(len, turns)) >= 3, turns


def test_a_standby_takes_over_from_an_agent_that_is_killed_but_not_from_one_that_thinks(scene: Scene) -> None:
    crew = [{"agent": VISITOR, "shadow": False}, {"agent": "min-height"}]
    scene.start_run([{"type": "relay", "name": "uav", "crew": crew}], trials=2, on_agent_loss="failover")
    scene.start_agent("mortal-thinker")
    assert scene.ended("visitor") == -signal.SIGKILL, scene.said()
    del scene.processes["visitor"]
    scene.finish()
    assert "visitor is lost in condition 0, trial 1; min-height takes over at step 50" in scene.channel_log()
    pilots = [step["flown_by"] for step in scene.steps("uav")[1]]
    assert pilots == ["visitor"] * 49 + ["min-height"] * 51


def test_the_site_map_says_the_same_as_to_an_agent_in_c(scene: Scene) -> None:
    agents = [{"type": "external", "name": name, "privilege": "site-map"} for name in ("visitor", "in-c")]
    scene.start_run(agents, trials=5, worlds=[{**WORLD, "site_map_error_m": 30}])
    scene.start_agent("near-sites")
    os.environ["CYCLONEDDS_URI"] = f"file://{SOURCE}/deploy/dds/cyclonedds-loopback.xml"
    foreign = [PROGRAMS / "aloft-foreign-agent", scene.domain, scene.run, "w0", "in-c", "site-map"]
    scene.start("in-c", foreign)
    scene.finish()
    ours, theirs = scene.steps("visitor"), scene.steps("in-c")
    assert sorted(ours) == list(range(5))
    for trial in ours:
        assert heights(ours[trial]) == heights(theirs[trial])
    assert max(max(heights(steps)) for steps in ours.values()) >= 100.0
