from typing import Any

import numpy as np
import pytest
from conftest import CITY, MEASURED

import aloft

pytest.importorskip("torch", reason="Stable-Baselines3 needs PyTorch (Debian: python3-torch)", exc_type=ImportError)
pytest.importorskip("stable_baselines3", exc_type=ImportError)

from stable_baselines3 import PPO  # noqa: E402
from stable_baselines3.common.env_checker import check_env  # noqa: E402
from stable_baselines3.common.vec_env import DummyVecEnv, VecMonitor  # noqa: E402

import aloft.sb3  # noqa: E402


@pytest.mark.parametrize("world", [CITY, MEASURED], ids=["city", "measured"])
@pytest.mark.parametrize("kwargs", [{}, {"observation": "dict", "history": 2, "site_map": 3}, {"privileged": True}], ids=str)
def test_the_checker_of_stable_baselines3_finds_nothing(world: Any, kwargs: dict[str, Any]) -> None:
    check_env(aloft.HeightEnv(world, **kwargs))


def test_equals_dummy_vec_env() -> None:
    dummy = DummyVecEnv([lambda: aloft.HeightEnv(MEASURED, history=1)] * 3)
    fast = aloft.sb3.vec_env(3, MEASURED, history=1)
    dummy.seed(5), fast.seed(5)
    assert np.array_equal(dummy.reset(), fast.reset())
    assert dummy.reset_infos == fast.reset_infos
    random = np.random.default_rng(1)
    for _ in range(130):
        actions = random.integers(3, size=3)
        one, other = dummy.step(actions), fast.step(actions)
        for a, b in zip(one[:3], other[:3], strict=True):
            assert a.dtype == b.dtype and np.array_equal(a, b)
        for a, b in zip(one[3], other[3], strict=True):
            assert a.keys() == b.keys()
            assert all(np.array_equal(a[key], b[key]) for key in a)
        assert dummy.reset_infos == fast.reset_infos


def test_an_agent_learns_on_it() -> None:
    envs = VecMonitor(aloft.sb3.vec_env(4, MEASURED))
    model = PPO("MlpPolicy", envs, n_steps=64, batch_size=64, n_epochs=1, seed=0, device="cpu").learn(512)
    assert model.num_timesteps == 512
    assert len(model.ep_info_buffer) == 8
    assert envs.env_method("trace")[0][:1] == b"\x08"
    envs.close()


@pytest.mark.parametrize("name", ["copy", "autoreset_mode"])
def test_what_would_spoil_training_is_refused(name: str) -> None:
    with pytest.raises(TypeError, match=f"vec_env takes no {name}"):
        aloft.sb3.vec_env(2, {}, **{name: False})
