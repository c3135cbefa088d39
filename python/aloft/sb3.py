"""The environments as Stable-Baselines3 wants several of them. Gymnasium's vector environments it does not take."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices

from aloft.vector import HeightVectorEnv

__all__ = ["vec_env"]


def vec_env(num_envs: int = 1, world: Any = None, *, num_threads: int = 0, **env_kwargs: Any) -> "HeightVecEnv":
    """``num_envs`` environments for Stable-Baselines3; the other arguments are those of :class:`aloft.HeightVectorEnv`, but
    for ``copy`` and ``autoreset_mode``: its buffers need copies, and flights that begin in the step that ends another."""
    for name in ("copy", "autoreset_mode"):
        if name in env_kwargs:
            raise TypeError(f"vec_env takes no {name}: Stable-Baselines3 needs copies, and autoreset in the same step")
    return HeightVecEnv(
        HeightVectorEnv(
            num_envs, world, num_threads=num_threads, autoreset_mode=AutoresetMode.SAME_STEP, **env_kwargs
        )
    )


class HeightVecEnv(VecEnv):  # type: ignore[misc]  # Stable-Baselines3 need not be there to check types
    """Made by :func:`vec_env`."""

    def __init__(self, envs: HeightVectorEnv) -> None:
        self.envs = envs
        self.render_mode = envs.render_mode
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)
        self.metadata = envs.metadata
        self._actions: Any = None

    def reset(self) -> Any:
        seeds = self._seeds if any(seed is not None for seed in self._seeds) else None
        options = next((one for one in self._options if one), None)
        observations, infos = self.envs.reset(seed=seeds, options=options)
        self.reset_infos = _by_environment(infos, self.num_envs)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: Any) -> None:
        self._actions = actions

    def step_wait(self) -> Any:
        observations, rewards, dones, _, infos = self.envs.step(self._actions)
        told = _by_environment(infos, self.num_envs)
        if dones.any():
            final = _by_environment(infos["final_info"], self.num_envs)
            for index in np.flatnonzero(dones):
                self.reset_infos[index] = told[index]
                told[index] = {**final[index], "terminal_observation": infos["final_obs"][index]}
        for info in told:
            info["TimeLimit.truncated"] = False
        return observations, rewards.astype(np.float32), dones, told

    def close(self) -> None:
        self.envs.close()

    def get_images(self) -> Sequence[Any]:
        pictures = self.envs.render() if self.render_mode == "rgb_array" else None
        return pictures or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        return [getattr(self.envs, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        raise AttributeError(f"{attr_name}: the environments are set up when they are made, and not changed later")

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:
        if method_name != "trace":
            raise AttributeError(f"{method_name}: the environments have only the method trace")
        return [self.envs.trace(index, *args, **kwargs) for index in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: VecEnvIndices = None) -> list[bool]:
        return [False] * len(list(self._get_indices(indices)))


def _by_environment(infos: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """Infos of arrays, as one dict for each environment."""
    told: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, values in infos.items():
        if name.startswith("_") or name in ("final_obs", "final_info"):
            continue
        plain = values if values.ndim > 1 else values.tolist()
        for index in np.flatnonzero(infos["_" + name]).tolist():
            told[index][name] = plain[index]
    return told
