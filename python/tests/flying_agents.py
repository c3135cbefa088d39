"""Agents that the tests fly. Usage: flying_agents.py AGENT DOMAIN RUN WORKER NAME [FILE]"""

import math
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from aloft import wire
from aloft.dds import Action, Agent, PolicyAgent


class Climber(Agent):
    """Climbs whenever it is asked: in a relay, its steps can be told from those of the others."""

    stateless = True

    def act(self, report: wire.ChannelReport) -> Action:
        return Action.ACTION_UP


class Stairs(Agent):
    """Four steps up, two steps down. It counts them, so it has to see a flight from its beginning."""

    def begin(self, report: wire.ChannelReport) -> None:
        self.steps = 0

    def act(self, report: wire.ChannelReport) -> Action:
        self.steps += 1
        return Action.ACTION_UP if (self.steps - 1) % 6 < 4 else Action.ACTION_DOWN


class NearSites(Agent):
    """As tests/foreign_agent with the site map: climbs while a base station is within 200 m of the next point."""

    privilege = "site-map"

    def survey(self, site_map: wire.SiteMap) -> None:
        self.near = [
            any(math.hypot(site.x_m - point.x_m, site.y_m - point.y_m) < 200.0 for site in site_map.sites)
            for point in site_map.route
        ]

    def act(self, report: wire.ChannelReport) -> Action:
        return Action.ACTION_UP if self.near[report.step] else Action.ACTION_DOWN


class Thinker(Climber):
    """At steps 1 and 30 of trial 1, computes for longer than the lease of its liveliness."""

    def act(self, report: wire.ChannelReport) -> Action:
        if report.trial == 1 and report.step in (0, 29):
            end = time.monotonic() + 2.0
            while time.monotonic() < end:
                pass
        return super().act(report)


class Recorder(PolicyAgent):
    """Flies a simple policy, and writes down what it observed."""

    def __init__(self, folder: Path) -> None:
        super().__init__(Zigzag(), history=2, site_map=3)
        self.folder = folder

    def begin(self, report: wire.ChannelReport) -> None:
        super().begin(report)
        self.policy = Zigzag()

    def act(self, report: wire.ChannelReport) -> Action:
        action = super().act(report)
        if report.step == report.steps - 1:
            np.save(self.folder / f"{report.condition}-{report.trial}.npy", self.policy.seen)
        return action


class Zigzag:
    """Up and down by turns of five steps; in the form of a model of Stable-Baselines3."""

    def __init__(self) -> None:
        self.seen: list[Any] = []

    def predict(self, observation: Any) -> tuple[Any, None]:
        self.seen.append(observation)
        return np.array(2 if len(self.seen) % 10 < 5 else 0), None


class HalfWay:
    """A policy that climbs to the middle of the heights."""

    def predict(self, observation: Any) -> int:
        return 2 if observation[1] < 0.5 else 1


def dies_at_step_50(kind: type[Agent], once: Path | None = None) -> type[Agent]:
    """Killed as by `kill -9` when it is asked for step 50 of trial 1; if a file is given, only while it is not there."""

    class Mortal(kind):
        def act(self, report: wire.ChannelReport) -> Action:
            if report.trial == 1 and report.step == 49 and not (once and once.exists()):
                if once:
                    once.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            return super().act(report)

    return Mortal


KINDS: dict[str, Callable[[Path | None], Agent]] = {
    "climber": lambda _: Climber(),
    "near-sites": lambda _: NearSites(),
    "half-way": lambda _: PolicyAgent(HalfWay()),
    "recorder": Recorder,
    "mortal-climber": lambda file: dies_at_step_50(Climber, file)(),
    "mortal-stairs": lambda file: dies_at_step_50(Stairs, file)(),
    "mortal-thinker": lambda file: dies_at_step_50(Thinker, file)(),
}

if __name__ == "__main__":
    kind, domain, run, worker, name, *file = sys.argv[1:]
    KINDS[kind](Path(file[0]) if file else None).run(int(domain), run, worker, name)
