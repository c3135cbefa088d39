"""Calls the package with whatever comes to mind, in one process, for a while. Exceptions of the usual types are fine,
anything else fails: other exceptions, a crash, an environment that does not fly any more.

    python python/tests/fuzz_binding.py [--seconds 600] [--seed 0]
"""

import argparse
import faulthandler
import pathlib
import random
import threading
import time
import warnings
from typing import Any

import numpy as np
from conftest import CITY, MEASURED, SAMPLE

import aloft
from aloft import _core

USUAL = (ValueError, TypeError, RuntimeError, OverflowError, FileNotFoundError, AttributeError)
KEYS = [
    *("kind", "file", "sites_file", "name", "swept", "preset", "route", "steps", "window_m", "propagation", "neighbours"),
    *("bs_density_per_km2", "min_base_stations", "building_density_per_km2", "building_width_m", "height_min_m"),
    *("height_max_m", "height_step_m", "height_resolution_m", "route_spacing_m", "uav_antenna", "bs_antenna", "fading"),
    *("fading_correlation", "serving_selection", "candidates", "site_map_error_m", "site_map_missing"),
    *("site_map_route_points", "los_ray", "uav_beamwidth_deg", "route_offset_max_m", "tx_power_w", "no_such_key"),
]
WORDS = [
    *("generated", "measured", "published", "paper-text", "geometric", "nearest", "serving", "none", "correlated"),
    *("flat", "dict", "next-step", "whole-route", "ansi", "rgb_array", "NextStep", "SameStep", "Disabled", "", "x" * 5000),
    *("\x00", "\ud800", "é\u202e", "{}", "[" * 5000, "nowhere.json", "/dev/zero", "/proc/self/mem", SAMPLE),
]


class Fuzzer:
    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.calls = 0
        self.accepted = 0

    def array(self) -> Any:
        shape = self.random.choice([(), (0,), (1,), (2,), (3,), (2, 2), (100_000,)])
        kind = self.random.choice(["i8", "u8", "i1", "f8", "f4", "c8", "?", "O", "U3", "M8[s]", ">i8", "i4,f4", "V3"])
        array = np.zeros(shape, kind)
        change = self.random.randrange(5)
        if change == 0:
            array = np.zeros((6,), kind)[::2]
        elif change == 1:
            array.flags.writeable = False
        elif change == 2 and kind == "i8":
            array = array + self.random.choice([1, 2, 3, -1, 2**62])
        elif change == 3:
            array = np.lib.stride_tricks.as_strided(array, (3,), (0,)) if array.size else array
        return array

    def value(self, depth: int = 0) -> Any:
        pick = self.random.choice
        kind = self.random.randrange(11 if depth < 3 else 7)
        if kind == 0:
            return pick([0, 1, 2, 3, -1, 7, 100, 2**31, 2**32, 2**63, 2**64, -(2**63), 10**30])
        if kind == 1:
            return pick([0.0, 0.5, -1.5, 20.0, 1e300, -0.0, float("nan"), float("inf"), -float("inf")])
        if kind in (2, 3):
            return pick(WORDS)
        if kind == 4:
            return pick([None, True, False, np.int64(1), np.float32(2), np.bool_(True), b"bytes", 1j, object(), int, len])
        if kind == 5:
            return self.array()
        if kind == 6:
            return pick([pathlib.Path("nowhere"), pathlib.Path(SAMPLE), range(3), iter([1]), Ellipsis, slice(2)])
        if kind == 7:
            return [self.value(depth + 1) for _ in range(self.random.randrange(4))]
        if kind == 8:
            return {pick([*KEYS, 5, None]): self.value(depth + 1) for _ in range(self.random.randrange(4))}
        if kind == 9:
            around: list[Any] = []
            around.append(around)
            return around
        return self.world()

    def world(self) -> Any:
        world: dict[Any, Any] = dict(self.random.choice([CITY, MEASURED, {}]))
        # Small, so that a call takes no second.
        world.update({} if world.get("kind") else {"steps": 20, "height_resolution_m": 10, "building_density_per_km2": 5})
        for _ in range(self.random.choice([0, 0, 0, 1, 2])):
            values = [1, 2, 10, 0, -1, 0.5, self.value(3), [1, 2], [0.5, 3]]
            world[self.random.choice(KEYS)] = self.random.choice(values)
        return world

    def maybe(self, usual: Any) -> Any:
        return self.value() if self.random.random() < 0.15 else usual

    def settings(self) -> dict[str, Any]:
        pick = self.random.choice
        usual = {
            "world": self.world(),
            "observation": pick(["flat", "dict"]),
            "history": pick([0, 1, 5]),
            "site_map": pick([0, 0, 1, 9]),
            "energy_weight": pick([None, 0.1]),
            "handover_cost": pick([None, 1.0]),
            "privileged": pick([False, False, True, "whole-route"]),
            "render_mode": pick([None, "ansi", "rgb_array"]),
        }
        chosen = self.random.sample(sorted(usual), self.random.randrange(len(usual)))
        return {name: self.maybe(usual[name]) for name in {*chosen, "world"}}

    def call(self, function: Any, *args: Any, **kwargs: Any) -> Any:
        self.calls += 1
        try:
            result = function(*args, **kwargs)
        except USUAL as error:
            assert str(error) or isinstance(error, RuntimeError), repr(error)
            return None
        self.accepted += 1
        return result

    def use(self, env: Any, action: Any) -> None:
        pick = self.random.choice
        for _ in range(self.random.randrange(40)):
            deed = self.random.randrange(12)
            if deed == 0:
                options = {pick(["trial", "condition", "reset_mask", "x"]): self.value() for _ in range(2)}
                self.call(env.reset, seed=self.maybe(3), options=self.maybe(pick([None, options])))
            elif deed == 1:
                self.call(env.reset)
            elif deed == 2:
                self.call(env.step, self.value())
            elif deed == 3:
                self.call(env.trace, self.maybe("a"))
                self.call(env.trace, self.value(), self.value())
            elif deed == 4 and self.random.random() < 0.3:
                self.call(env.render)
            elif deed == 5:
                self.call(setattr, env, pick(["render_mode", "num_envs", "x"]), env.render_mode)
            else:
                self.call(env.step, action)

    def single(self) -> None:
        env = self.call(aloft.HeightEnv, **self.settings())
        if env is not None:
            self.use(env, self.random.randrange(3))

    def vector(self) -> None:
        settings = self.settings()
        count = self.maybe(self.random.choice([1, 2, 3, 17]))
        settings["num_threads"] = self.maybe(self.random.choice([0, 1, 2, 5]))
        settings["autoreset_mode"] = self.maybe(self.random.choice(["NextStep", "SameStep", "Disabled"]))
        settings["copy"] = self.random.random() < 0.5
        if isinstance(count, int) and count > 1000:
            count = 2  # allowed, but slow
        envs = self.call(aloft.HeightVectorEnv, count, **settings)
        if envs is None:
            return
        actions = np.ones(envs.num_envs, np.int64)
        if self.random.random() < 0.2:
            other = threading.Thread(target=lambda: [self.call(envs.step, actions) for _ in range(20)])
            other.start()
            self.use(envs, actions)
            other.join()
        else:
            self.use(envs, actions)

    def core(self) -> None:
        """The module beneath, which nobody should use, but can."""
        pick = self.random.choice
        self.call(_core.Worlds.from_json, self.value(), self.value(), self.value(), self.maybe([]))
        self.call(_core.Worlds.from_file, self.value(), None, None, self.maybe(["site-map", "next-step"]))
        worlds = self.call(_core.Worlds.from_json, '{"steps": 9, "building_density_per_km2": 5}', None, None, [])
        self.call(worlds.scene, self.maybe(0), self.maybe(1), self.maybe(2))
        fleet = self.call(
            *(_core.Fleet, self.maybe(worlds), self.maybe(2), self.maybe(2), self.maybe(1), self.maybe(3)),
            *(self.maybe(pick(list(_core.Foresight))), self.maybe(pick(list(_core.Autoreset)))),
        )
        raw = _core.Fleet.__new__(_core.Fleet)
        for one in (fleet, raw):
            if one is None:
                continue
            two = np.ones(2, np.uint32)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # nanobind warns of what has not been made
                for _ in range(10):
                    deed = pick(["reset", "step", "facts", "flown", "profiles", "trace", "columns", "other"])
                    if deed == "reset":
                        seeds, chosen = np.ones(2, np.uint64), np.ones(2, np.uint8)
                        self.call(one.reset, *map(self.maybe, (seeds, two, two * 0, chosen)))
                    elif deed == "other":
                        self.call(one.step, self.array())
                    else:
                        arguments = {"step": [np.ones(2, np.int64)], "trace": [0, "a"], "columns": []}.get(deed, [1])
                        self.call(getattr(one, deed), *map(self.maybe, arguments))

    def still_flies(self) -> None:
        env = aloft.HeightEnv(MEASURED)
        env.reset(seed=1)
        assert sum(env.step(2)[1] for _ in range(60)) > 0


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    faulthandler.enable()
    warnings.simplefilter("ignore")
    fuzzer = Fuzzer(arguments.seed)
    end = time.monotonic() + arguments.seconds
    rounds = 0
    while rounds < 200 or time.monotonic() < end:
        fuzzer.random.choice([fuzzer.single, fuzzer.vector, fuzzer.core])()
        rounds += 1
        if rounds % 100 == 0:
            fuzzer.still_flies()
    fuzzer.still_flies()
    print(f"seed {arguments.seed}: {rounds} rounds, {fuzzer.calls} calls, {fuzzer.accepted} of them accepted")


if __name__ == "__main__":
    main()
