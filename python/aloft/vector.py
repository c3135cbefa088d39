"""Many UAVs as a Gymnasium vector environment, stepped by threads of the C++ core."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.utils import EzPickle
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

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
    seed_of,
)
from aloft.env import HeightEnv

__all__ = ["HeightVectorEnv"]

_CORE_MODE = {
    AutoresetMode.NEXT_STEP: _core.Autoreset.NEXT_STEP,
    AutoresetMode.SAME_STEP: _core.Autoreset.SAME_STEP,
    AutoresetMode.DISABLED: _core.Autoreset.DISABLED,
}
_NUMBER = {name: index for index, name in enumerate(_core.NUMBERS)}
_INTEGER = {name: index for index, name in enumerate(_core.INTEGERS)}
_FLAG = {name: index for index, name in enumerate(_core.FLAGS)}
_MOST_SEED = 2**63 - 1  # infos are int64, as those of SyncVectorEnv

Arrays = tuple[Any, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]


class HeightVectorEnv(VectorEnv[Any, Any, Any], EzPickle):
    """``num_envs`` environments that are :class:`HeightEnv`, and give what a ``SyncVectorEnv`` of them gives.

    :param num_threads: how many threads step them; 0: one per core that this process may use. Results do not depend on it.
    :param autoreset_mode: when an environment whose flight has ended begins the next trial.
    :param copy: whether observations are copies; else they are views, which the next call overwrites.
    """

    def __init__(
        self,
        num_envs: int = 1,
        world: World = None,
        *,
        num_threads: int = 0,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
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
            num_envs,
            world,
            num_threads=num_threads,
            autoreset_mode=autoreset_mode,
            copy=copy,
            observation=observation,
            history=history,
            energy_weight=energy_weight,
            handover_cost=handover_cost,
            privileged=privileged,
            render_mode=render_mode,
            site_map=site_map,
        )
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {**HeightEnv.metadata, "autoreset_mode": self.autoreset_mode}
        self.render_mode = render_mode
        self.copy = bool(copy)
        self._settings = Settings(
            world, observation, history, site_map, energy_weight, handover_cost, privileged, render_mode
        )
        self._fleet = self._settings.fleet(num_envs, num_threads, _CORE_MODE[self.autoreset_mode])
        self.num_envs = int(num_envs)
        self.single_observation_space = self._settings.space()
        self.single_action_space = gym.spaces.Discrete(3)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._columns = self._fleet.columns()
        self._observation = self._settings.shaped(self._columns["observation"])
        self._seeded = np.zeros(self.num_envs, np.bool_)
        self._painters: dict[int, Any] = {}

    @property
    def conditions(self) -> list[str]:
        """The names of the conditions, in the order of their numbers."""
        return self._settings.worlds.conditions

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begins flights as :meth:`HeightEnv.reset`; an int seeds environment i with ``seed + i``. The option ``reset_mask``
        names those that begin; ``trial`` and ``condition`` are one number for all, or one for each."""
        options = check_options(options, ("trial", "condition", "reset_mask"))
        chosen = self._mask(options.get("reset_mask"))
        seeds, fresh = self._given_seeds(seed)
        if isinstance(seed, int):
            super().reset(seed=seed)
        unseeded = chosen & ~fresh & ~self._seeded
        if unseeded.any():
            seeds[unseeded] = self.np_random.integers(2**63, size=int(unseeded.sum()), dtype=np.uint64)
        goes_on = chosen & ~fresh & self._seeded
        integers = self._columns["integer"]
        seeds = np.where(goes_on, integers[_INTEGER["seed"]].astype(np.uint64), seeds)
        trials = np.where(goes_on, integers[_INTEGER["trial"]] + 1, 0)
        if options.get("trial") is None:
            check_next_trial(int(np.where(chosen, trials, 0).max()))
        trials = self._each(options, "trial", trials)
        conditions = self._each(options, "condition", integers[_INTEGER["condition"]])
        self._fleet.reset(seeds, trials, conditions, chosen.view(np.uint8))
        self._seeded |= chosen
        return self._observations(), self._reset_infos()

    def step(self, actions: Any) -> Arrays:
        """One action for each environment: 0 down, 1 hold, 2 up."""
        given = np.asarray(actions)
        if given.dtype.kind not in "iu" or given.shape != (self.num_envs,):
            raise ValueError(
                f"actions: {given.dtype} of shape {given.shape} is not allowed; use {self.num_envs} whole numbers: "
                "0 (down), 1 (hold) or 2 (up)"
            )
        self._fleet.step(np.ascontiguousarray(given, np.int64))
        numbers = self._columns["number"].copy()
        flags = self._columns["flag"].copy()
        terminated = flags[_FLAG["terminated"]]
        infos = self._step_infos(numbers, flags)
        truncated = np.zeros(self.num_envs, np.bool_)
        return self._observations(), numbers[_NUMBER["reward"]], terminated, truncated, infos

    def trace(self, index: int, agent: str = "python") -> bytes:
        """:meth:`HeightEnv.trace` of the present flight of one environment."""
        return self._fleet.trace(index, agent)

    def render(self) -> tuple[Any, ...] | None:
        """What :meth:`HeightEnv.render` gives, for each environment."""
        if self.render_mode is None:
            gym.logger.warn('render() does nothing without a render_mode; make the environment with "ansi" or "rgb_array"')
            return None
        from aloft._render import Painter

        for index in range(self.num_envs):
            self._painters.setdefault(index, Painter(self._settings.worlds, self._fleet, index))
        painters = (self._painters[index] for index in range(self.num_envs))
        return tuple(one.text() if self.render_mode == "ansi" else one.picture() for one in painters)

    def _mask(self, mask: Any) -> NDArray[np.bool_]:
        if mask is None:
            return np.ones(self.num_envs, np.bool_)
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            kind = mask.dtype if isinstance(mask, np.ndarray) else type(mask).__name__
            raise TypeError(f'options["reset_mask"]: {kind} is not allowed; use an array of bool')
        if mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(
                f'options["reset_mask"]: shape {mask.shape} with {mask.sum()} True is not allowed; use shape '
                f"({self.num_envs},) with at least one True"
            )
        return np.ascontiguousarray(mask)

    def _given_seeds(self, seed: Any) -> tuple[NDArray[np.uint64], NDArray[np.bool_]]:
        """The seeds that are given, and which these are."""
        given: list[Any]
        if seed is None:
            given = [None] * self.num_envs
        elif isinstance(seed, (list, tuple, np.ndarray)):
            given = list(seed)
        else:
            first = seed_of(seed, _MOST_SEED)
            given = [first + index for index in range(self.num_envs)]
        if len(given) != self.num_envs:
            raise ValueError(f"seed: {len(given)} seeds for {self.num_envs} environments; give one each")
        seeds = np.array([0 if one is None else seed_of(one, _MOST_SEED) for one in given], np.uint64)
        return seeds, np.array([one is not None for one in given], np.bool_)

    def _each(self, options: dict[str, Any], name: str, default: NDArray[Any]) -> NDArray[np.uint32]:
        given = options.get(name)
        if given is None:
            return default.astype(np.uint32)
        values = np.asarray(given)
        if values.dtype.kind not in "iu" or values.shape not in ((), (self.num_envs,)):
            raise ValueError(
                f'options["{name}"]: {values.dtype} of shape {values.shape} is not allowed; use a whole number, or '
                f"{self.num_envs} of them"
            )
        if ((values < 0) | (values >= 2**32)).any():
            raise ValueError(f'options["{name}"]: {given!r} is not allowed; use whole numbers from 0 to {2**32 - 1}')
        return np.ascontiguousarray(np.broadcast_to(values, (self.num_envs,)), np.uint32)

    def _observations(self) -> Any:
        if not self.copy:
            return self._observation
        return self._settings.shaped(self._columns["observation"].copy())

    def _reset_infos(self) -> dict[str, Any]:
        flags = self._columns["flag"].copy()
        infos: dict[str, Any] = {}
        self._add_reset(infos, flags[_FLAG["began"]])
        self._add_foresight(infos, flags[_FLAG["foreseen"]])
        return infos

    def _step_infos(self, numbers: NDArray[np.float64], flags: NDArray[np.bool_]) -> dict[str, Any]:
        infos: dict[str, Any] = {}
        stepped, began, ended = (flags[_FLAG[name]] for name in ("stepped", "began", "terminated"))
        integers = self._columns["integer"].copy()
        handover = flags[_FLAG["handover"]]
        if self.autoreset_mode == AutoresetMode.SAME_STEP and ended.any():
            stay = ~ended
            final: dict[str, Any] = {}
            self._add_step(final, numbers * ended, integers * ended, handover & ended, ended)
            self._add_final(infos, final, ended)
            if stay.any():
                self._add_step(infos, numbers * stay, integers * stay, handover & stay, stay)
        elif stepped.any():
            self._add_step(infos, numbers, integers, handover, stepped)
        if began.any():
            self._add_reset(infos, began)
        self._add_foresight(infos, flags[_FLAG["foreseen"]])
        return infos

    def _add_step(
        self,
        infos: dict[str, Any],
        numbers: NDArray[np.float64],
        integers: NDArray[np.int64],
        handover: NDArray[np.bool_],
        mask: NDArray[np.bool_],
    ) -> None:
        for name in STEP_NUMBERS:
            infos[name] = numbers[_NUMBER[name]]
            infos["_" + name] = mask
        for name in STEP_INTEGERS:
            infos[name] = integers[_INTEGER[name]]
            infos["_" + name] = mask
        infos["handover"] = handover
        infos["_handover"] = mask

    def _add_reset(self, infos: dict[str, Any], mask: NDArray[np.bool_]) -> None:
        for name in RESET_INTEGERS:
            infos[name] = self._columns["integer"][_INTEGER[name]] * mask
            infos["_" + name] = mask

    def _add_final(self, infos: dict[str, Any], final: dict[str, Any], mask: NDArray[np.bool_]) -> None:
        observations = np.full(self.num_envs, None, dtype=object)
        for index in np.flatnonzero(mask):
            observations[index] = self._settings.shaped(self._columns["final_observation"][index].copy())
        infos["final_obs"], infos["_final_obs"] = observations, mask
        infos["final_info"], infos["_final_info"] = final, mask

    def _add_foresight(self, infos: dict[str, Any], mask: NDArray[np.bool_]) -> None:
        if not mask.any():
            return
        whole = self._settings.foresight == _core.Foresight.WHOLE_ROUTE
        name = "profiles" if whole else "profile"
        profiles = self._columns["profile"] if whole else self._columns["profile"][:, 0]
        shape = (self.num_envs,) + (1,) * (profiles.ndim - 1)
        infos[name], infos["_" + name] = profiles * mask.reshape(shape), mask
