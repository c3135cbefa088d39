"""One UAV as a Gymnasium environment."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.utils import EzPickle

from aloft import _core
from aloft._settings import (
    RESET_INTEGERS,
    STEP_INTEGERS,
    STEP_NUMBERS,
    Observation,
    Privileged,
    Settings,
    World,
    check_next_trial,
    check_options,
    option,
    seed_of,
)

__all__ = ["HeightEnv"]

_NUMBER = {name: index for index, name in enumerate(_core.NUMBERS)}
_INTEGER = {name: index for index, name in enumerate(_core.INTEGERS)}
_FLAG = {name: index for index, name in enumerate(_core.FLAGS)}


class HeightEnv(gym.Env[Any, np.int64], EzPickle):
    """A UAV that flies over a city and chooses its height at each step: ``Aloft/Height-v0``.

    :param world: as ``"world"`` in an experiment file, or the path of such a file, whose agents are ignored. Lists in it
        make several conditions.
    :param observation: ``"flat"`` for one array, ``"dict"`` for its parts by name.
    :param history: how many earlier reports an observation has beside the newest one.
    :param energy_weight: subtracted from the reward per joule; ``None``: what the file says, or 0.
    :param handover_cost: subtracted from the reward per handover; ``None``: what the file says, or 0.
    :param privileged: adds foresight to the infos: ``"next-step"`` (or ``True``) the quality at every height where the next
        step's result will be read, as ``profile``; ``"whole-route"`` that of all steps at the reset.
    :param render_mode: ``"ansi"``, or ``"rgb_array"``, which needs Pillow.
    :param site_map: how many of the operator's nearest sites an observation has; 0: no site map.
    """

    metadata: dict[str, Any] = {"render_modes": ["ansi", "rgb_array"], "render_fps": 10}

    def __init__(
        self,
        world: World = None,
        *,
        observation: Observation = "flat",
        history: int = 0,
        energy_weight: float | None = None,
        handover_cost: float | None = None,
        privileged: Privileged = False,
        render_mode: str | None = None,
        site_map: int = 0,
    ) -> None:
        EzPickle.__init__(
            self,
            world,
            observation=observation,
            history=history,
            energy_weight=energy_weight,
            handover_cost=handover_cost,
            privileged=privileged,
            render_mode=render_mode,
            site_map=site_map,
        )
        self._settings = Settings(
            world, observation, history, site_map, energy_weight, handover_cost, privileged, render_mode
        )
        self.render_mode = render_mode
        self._fleet = self._settings.fleet(1, 1, _core.Autoreset.DISABLED)
        self.observation_space = self._settings.space()
        self.action_space = gym.spaces.Discrete(3)
        self._columns = self._fleet.columns()
        self._seed: int | None = None
        self._trial = 0
        self._condition = 0
        self._painter: Any = None

    @property
    def conditions(self) -> list[str]:
        """The names of the conditions, in the order of their numbers."""
        return self._settings.worlds.conditions

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begins a flight: trial 0 of ``seed``, later without a seed the next trial. The options ``trial`` and ``condition``
        choose others; a condition stays until another one is chosen. The first seed is random if none is given."""
        options = check_options(options, ("trial", "condition"))
        if seed is not None:
            next_seed, next_trial = seed_of(seed, 2**64 - 1), 0
        elif self._seed is None:
            next_seed, next_trial = int(self.np_random.integers(2**63)), 0
        else:
            next_seed, next_trial = self._seed, self._trial
        trial, condition = option(options, "trial"), option(options, "condition")
        trial = next_trial if trial is None else trial
        condition = self._condition if condition is None else condition
        check_next_trial(trial)
        super().reset(seed=None if seed is None else next_seed)
        self._fleet.reset(
            np.array([next_seed], np.uint64),
            np.array([trial], np.uint32),
            np.array([condition], np.uint32),
            np.ones(1, np.uint8),
        )
        self._seed, self._trial, self._condition = next_seed, trial + 1, condition
        integers = self._columns["integer"][:, 0]
        info: dict[str, Any] = {name: int(integers[_INTEGER[name]]) for name in RESET_INTEGERS}
        info["seed"] = next_seed
        return self._observation(), self._with_foresight(info)

    def step(self, action: np.int64) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """0: down, 1: hold, 2: up. The route's end terminates the flight."""
        if isinstance(action, (bool, np.bool_)) or not hasattr(action, "__index__"):
            raise ValueError(f"action: {action!r} is not allowed; use 0 (down), 1 (hold) or 2 (up)")
        number = action.__index__()
        self._fleet.step(np.array([number if 0 <= number <= 2 else -1 if number < 0 else 3], np.int64))
        numbers = self._columns["number"][:, 0].tolist()
        integers = self._columns["integer"][:, 0].tolist()
        flags = self._columns["flag"][:, 0].tolist()
        info: dict[str, Any] = {name: numbers[_NUMBER[name]] for name in STEP_NUMBERS}
        info.update({name: integers[_INTEGER[name]] for name in STEP_INTEGERS})
        info["handover"] = flags[_FLAG["handover"]]
        reward, terminated = numbers[_NUMBER["reward"]], flags[_FLAG["terminated"]]
        return self._observation(), reward, terminated, False, self._with_foresight(info)

    def trace(self, agent: str = "python") -> bytes:
        """The flight so far as the result database stores it, flown by an agent of this name. Its SHA-256 is the digest of
        the flight."""
        return self._fleet.trace(0, agent)

    def render(self) -> Any:
        """The present flight: a text, or a picture as an array of shape (height, width, 3)."""
        if self.render_mode is None:
            gym.logger.warn('render() does nothing without a render_mode; make the environment with "ansi" or "rgb_array"')
            return None
        if self._painter is None:
            from aloft._render import Painter

            self._painter = Painter(self._settings.worlds, self._fleet)
        return self._painter.text() if self.render_mode == "ansi" else self._painter.picture()

    def _observation(self) -> Any:
        return self._settings.shaped(self._columns["observation"][0].copy())

    def _with_foresight(self, info: dict[str, Any]) -> dict[str, Any]:
        if self._columns["flag"][_FLAG["foreseen"], 0]:
            profile = self._columns["profile"][0]
            if self._settings.foresight == _core.Foresight.WHOLE_ROUTE:
                info["profiles"] = profile.copy()
            else:
                info["profile"] = profile[0].copy()
        return info
