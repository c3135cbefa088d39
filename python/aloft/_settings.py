"""What both environments share: their worlds, their spaces, the names of their infos."""

import json
import os
from typing import Any, Literal

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from aloft import _core

World = dict[str, Any] | str | os.PathLike[str] | None
Observation = Literal["flat", "dict"]
Privileged = bool | Literal["next-step", "whole-route"]

#: Infos of a step and of a reset, by the kind of their column.
STEP_NUMBERS = ("height_m", "x_m", "y_m", "qos", "energy_j")
STEP_INTEGERS = ("serving_cell", "executed")
RESET_INTEGERS = ("seed", "trial", "steps", "condition")

_FORESIGHT = {
    False: (_core.Foresight.NONE, None),
    True: (_core.Foresight.NEXT_STEP, "next-step"),
    "next-step": (_core.Foresight.NEXT_STEP, "next-step"),
    "whole-route": (_core.Foresight.WHOLE_ROUTE, "whole-route"),
}


def _whole_number(name: str, value: Any) -> int:
    if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
        raise TypeError(f"{name}: {value!r} is not allowed; use a whole number")
    number = value.__index__()
    if not 0 <= number < 2**32:
        raise ValueError(f"{name}: {number} is not allowed; use a whole number from 0 to {2**32 - 1}")
    return int(number)


def _number(name: str, value: Any) -> float | None:
    if value is None:
        return None
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise type(error)(f"{name}: {value!r} is not allowed; use a number") from None


class Settings:
    """Checked arguments of an environment."""

    def __init__(
        self,
        world: World,
        observation: Observation,
        history: int,
        site_map: int,
        energy_weight: float | None,
        handover_cost: float | None,
        privileged: Privileged,
        render_mode: str | None,
    ) -> None:
        if observation not in ("flat", "dict"):
            raise ValueError(f'observation: {observation!r} is not allowed; use "flat" or "dict"')
        if not isinstance(privileged, (bool, str)) or privileged not in _FORESIGHT:
            raise ValueError(
                f'privileged: {privileged!r} is not allowed; use False, True, "next-step" or "whole-route"'
            )
        if render_mode not in (None, "ansi", "rgb_array"):
            raise ValueError(f'render_mode: {render_mode!r} is not allowed; use None, "ansi" or "rgb_array"')
        self.observation = observation
        self.history = _whole_number("history", history)
        self.site_map = _whole_number("site_map", site_map)
        self.render_mode = render_mode
        self.foresight, tier = _FORESIGHT[privileged]
        tiers = [name for name in ("site-map" if self.site_map else None, tier) if name]
        costs = _number("energy_weight", energy_weight), _number("handover_cost", handover_cost)
        self.worlds = self._read(world, costs, tiers)

    @staticmethod
    def _read(world: World, costs: tuple[float | None, float | None], tiers: list[str]) -> _core.Worlds:
        if isinstance(world, (str, os.PathLike)):
            return _core.Worlds.from_file(os.fspath(world), *costs, tiers)
        if world is not None and not isinstance(world, dict):
            raise TypeError(
                f"world: {type(world).__name__} is not allowed; use a dict as in experiment files, or a file's path"
            )
        return _core.Worlds.from_json(json.dumps(world or {}), *costs, tiers)

    def fleet(self, num_envs: int, num_threads: int, autoreset: _core.Autoreset) -> _core.Fleet:
        count, threads = _whole_number("num_envs", num_envs), _whole_number("num_threads", num_threads)
        return _core.Fleet(self.worlds, count, threads, self.history, self.site_map, self.foresight, autoreset)

    def space(self) -> gym.Space[Any]:
        """The observation space of one environment."""
        low, high = (self._bounds(which) for which in (2, 3))
        if self.observation == "flat":
            return gym.spaces.Box(low, high, dtype=np.float32)
        lows, highs = self.parts(low), self.parts(high)
        return gym.spaces.Dict({name: gym.spaces.Box(lows[name], highs[name], dtype=np.float32) for name in lows})

    def _bounds(self, which: int) -> NDArray[np.float32]:
        bounds = [field[which] for field in _core.REPORT_FIELDS for _ in range(field[1] * (1 + self.history))]
        if self.site_map:
            site = [field[which] for field in _core.SITE_FIELDS for _ in range(field[1])]
            bounds += site * self.site_map + [field[which] for field in _core.ROUTE_FIELDS for _ in range(field[1])]
        return np.array(bounds, dtype=np.float32)

    def shaped(self, flat: NDArray[np.float32]) -> Any:
        """Observations as the space has them: the array itself, or views of its parts."""
        return flat if self.observation == "flat" else self.parts(flat)

    def parts(self, flat: NDArray[np.float32]) -> dict[str, NDArray[np.float32]]:
        """Views of the parts of one observation, or of several in rows."""
        sizes = {name: values * (1 + self.history) for name, values, _, _ in _core.REPORT_FIELDS}
        if self.site_map:
            sizes["sites"] = self.site_map * sum(values for _, values, _, _ in _core.SITE_FIELDS)
            sizes["route"] = sum(values for _, values, _, _ in _core.ROUTE_FIELDS)
        parts = {}
        at = 0
        for name, size in sizes.items():
            parts[name] = flat[..., at : at + size]
            at += size
        return parts


def seed_of(value: Any, most: int) -> int:
    """A seed as the core takes it; ``most`` is the greatest one allowed."""
    if isinstance(value, (bool, np.bool_)) or not hasattr(value, "__index__"):
        raise TypeError(f"seed: {value!r} is not allowed; use a whole number from 0 to {most}")
    seed = int(value.__index__())
    if not 0 <= seed <= most:
        raise ValueError(f"seed: {seed} is not allowed; use a whole number from 0 to {most}")
    return seed


def check_next_trial(trial: int) -> None:
    """Trials are counted in 32 bits."""
    if trial >= 2**32:
        raise ValueError(f"there is no trial after {trial - 1}; reset with another seed")


def check_options(options: Any, known: tuple[str, ...]) -> dict[str, Any]:
    """The options of a reset: TypeError and ValueError name what is wrong."""
    if options is None:
        return {}
    if not isinstance(options, dict):
        raise TypeError(f"options: {type(options).__name__} is not allowed; use a dict")
    for key in options:
        if key not in known:
            raise ValueError(f"options: unknown key {key!r}; use {', '.join(known)}")
    return options


def option(options: dict[str, Any], name: str) -> int | None:
    return None if options.get(name) is None else _whole_number(f'options["{name}"]', options[name])
