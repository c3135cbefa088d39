import os
import threading
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from conftest import CITY, MEASURED, WORLDS
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import aloft

COUNT = 5
#: Of different lengths, so that flights end at different times.
MIXED = {**CITY, "route_length_m": [400, 500]}


def assert_same(one: Any, other: Any, where: str = "") -> None:
    assert type(one) is type(other), where
    if isinstance(one, dict):
        assert one.keys() == other.keys(), where
        for key in one:
            assert_same(one[key], other[key], f"{where}/{key}")
    elif isinstance(one, np.ndarray) and one.dtype == object:
        assert one.shape == other.shape, where
        for index, pair in enumerate(zip(one, other, strict=True)):
            assert_same(*pair, f"{where}[{index}]")
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, where
        assert np.array_equal(one, other), where
    elif isinstance(one, tuple):
        for index, pair in enumerate(zip(one, other, strict=True)):
            assert_same(*pair, f"{where}({index})")
    else:
        assert one == other, where


def both(world: Any, mode: AutoresetMode, **kwargs: Any) -> tuple[SyncVectorEnv, aloft.HeightVectorEnv]:
    make: Callable[[], Any] = lambda: aloft.HeightEnv(world, **kwargs)  # noqa: E731
    sync = SyncVectorEnv([make] * COUNT, autoreset_mode=mode)
    return sync, aloft.HeightVectorEnv(COUNT, world, num_threads=2, autoreset_mode=mode, **kwargs)


@pytest.mark.parametrize(
    "kwargs",
    [{}, {"observation": "dict", "history": 2}, {"privileged": True}, {"privileged": "whole-route"}, {"site_map": 3}],
    ids=str,
)
@pytest.mark.parametrize("mode", AutoresetMode)
def test_equals_sync_vector_env_key_by_key(mode: AutoresetMode, kwargs: dict[str, Any]) -> None:
    sync, fast = both(MEASURED, mode, **kwargs)
    assert_same(sync.reset(seed=0), fast.reset(seed=0))
    assert (sync.observation_space, sync.action_space) == (fast.observation_space, fast.action_space)
    assert (sync.single_observation_space, sync.single_action_space) == (
        fast.single_observation_space,
        fast.single_action_space,
    )
    assert sync.metadata == fast.metadata
    random = np.random.default_rng(1)
    ended = np.zeros(COUNT, np.bool_)
    for number in range(250):
        if mode == AutoresetMode.DISABLED and ended.any():
            arguments = {"options": {"reset_mask": ended.copy()}}
            assert_same(sync.reset(**arguments), fast.reset(options={"reset_mask": ended.copy()}))
        elif number in (20, 21, 47):  # so that flights end at different times
            mask = random.random(COUNT) < 0.5
            mask[number % COUNT] = True
            seeds = [None if index % 2 else 100 + index for index in range(COUNT)]
            assert_same(
                sync.reset(seed=seeds, options={"reset_mask": mask.copy()}),
                fast.reset(seed=seeds, options={"reset_mask": mask.copy()}),
            )
        actions = random.integers(3, size=COUNT)
        told = fast.step(actions)
        assert_same(sync.step(actions), told, f"step {number}")
        ended = told[2] | told[3]


@pytest.mark.parametrize("world", ["published", "serving"])
def test_equals_sync_vector_env_over_cities(world: str) -> None:
    sync, fast = both(WORLDS[world], AutoresetMode.SAME_STEP)
    assert_same(sync.reset(seed=7), fast.reset(seed=7))
    random = np.random.default_rng(2)
    for number in range(120):
        actions = random.integers(3, size=COUNT)
        assert_same(sync.step(actions), fast.step(actions), f"step {number}")


def test_make_vec_makes_it() -> None:
    envs = gym.make_vec("Aloft/Height-v0", num_envs=3, vectorization_mode="vector_entry_point", world=MEASURED)
    assert isinstance(envs.unwrapped, aloft.HeightVectorEnv)
    assert envs.reset(seed=0)[0].shape == (3, 14)
    assert "autoreset_mode" not in aloft.HeightEnv.metadata
    envs.close()


def test_options_are_one_for_all_or_one_for_each() -> None:
    envs = aloft.HeightVectorEnv(3, {**CITY, "bs_density_per_km2": [1, 5]})
    infos = envs.reset(seed=4, options={"trial": 2, "condition": [0, 1, 0]})[1]
    assert infos["seed"].tolist() == [4, 5, 6]
    assert infos["trial"].tolist() == [2, 2, 2]
    assert infos["condition"].tolist() == [0, 1, 0]
    assert envs.reset()[1]["trial"].tolist() == [3, 3, 3]
    alone = aloft.HeightEnv({**CITY, "bs_density_per_km2": [1, 5]})
    expected = alone.reset(seed=5, options={"trial": 3, "condition": 1})[0]
    assert np.array_equal(envs.reset(seed=[9, 5, 9], options={"trial": 3})[0][1], expected)


def test_random_seeds_differ_and_are_told() -> None:
    envs = aloft.HeightVectorEnv(4, MEASURED)
    seeds = envs.reset()[1]["seed"]
    assert len(set(seeds.tolist())) == 4
    assert envs.reset()[1]["seed"].tolist() == seeds.tolist()


def test_without_copies_the_next_call_overwrites() -> None:
    for copies in (True, False):
        envs = aloft.HeightVectorEnv(2, MEASURED, copy=copies, observation="dict", history=1)
        first = envs.reset(seed=1)[0]
        before = first["step"].copy()
        second = envs.step(np.array([1, 1]))[0]
        assert np.array_equal(first["step"], before) == copies
        assert np.shares_memory(first["step"], second["step"]) != copies


def test_views_outlive_their_environment() -> None:
    observation = aloft.HeightVectorEnv(2, MEASURED, copy=False).reset(seed=1)[0]
    assert np.isfinite(observation).all()


def test_threads_change_nothing() -> None:
    told = []
    for threads in (1, 2, 7):
        envs = aloft.HeightVectorEnv(23, CITY, num_threads=threads)
        envs.reset(seed=1)
        told.append([envs.step(np.arange(23) % 3) for _ in range(5)])
    for other in told[1:]:
        for one, two in zip(told[0], other, strict=True):
            assert_same(one, two)


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # that is what is tested
def test_a_child_process_flies_on_with_threads_of_its_own() -> None:
    envs = aloft.HeightVectorEnv(8, MEASURED, num_threads=3)
    envs.reset(seed=1)
    envs.step(np.ones(8, np.int64))  # the threads are running
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        told = b"failed"
        try:
            told = envs.step(np.ones(8, np.int64))[0].tobytes()
        finally:
            os.write(writing, told)
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        assert pipe.read() == envs.step(np.ones(8, np.int64))[0].tobytes()
    os.waitpid(child, 0)


def test_two_threads_at_once_are_refused_and_not_mixed() -> None:
    envs = aloft.HeightVectorEnv(64, CITY, num_threads=1)
    envs.reset(seed=1)
    refused = []

    def step() -> None:
        for _ in range(20):
            try:
                envs.step(np.ones(64, np.int64))
            except RuntimeError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=step) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(refused) < 80
    assert all("another thread" in message or "at its end" in message for message in refused)


BAD_CALLS: list[tuple[Callable[[Any], Any], type[Exception], str]] = [
    (lambda envs: envs.step(np.array([1, 3])), ValueError, "action: 3"),
    (lambda envs: envs.step(np.array([1, 1, 1])), ValueError, r"shape \(3,\)"),
    (lambda envs: envs.step(np.array([1.0, 1.0])), ValueError, "float64"),
    (lambda envs: envs.step("up"), ValueError, "actions"),
    (lambda envs: envs.step(np.array([2**64 - 1, 0], np.uint64)), ValueError, "action: -1"),
    (lambda envs: envs.reset(seed=-1), ValueError, "seed: -1"),
    (lambda envs: envs.reset(seed=2**63), ValueError, "seed"),
    (lambda envs: envs.reset(seed=[1]), ValueError, "1 seeds for 2"),
    (lambda envs: envs.reset(seed="1"), TypeError, "seed"),
    (lambda envs: envs.reset(options={"trial": [1, 2, 3]}), ValueError, "trial"),
    (lambda envs: envs.reset(options={"trial": -1}), ValueError, "trial"),
    (lambda envs: envs.reset(options={"condition": 9}), ValueError, "condition: 9"),
    (lambda envs: envs.reset(options={"mask": 1}), ValueError, "mask"),
    (lambda envs: envs.reset(options={"reset_mask": [True, False]}), TypeError, "reset_mask"),
    (lambda envs: envs.reset(options={"reset_mask": np.zeros(2, np.bool_)}), ValueError, "reset_mask"),
    (lambda envs: envs.reset(options={"reset_mask": np.ones(3, np.bool_)}), ValueError, "reset_mask"),
    (lambda envs: envs.trace(2), ValueError, "no environment 2"),
    (lambda envs: envs.trace(-1), TypeError, "."),
]


@pytest.mark.parametrize(("call", "error", "message"), BAD_CALLS)
def test_calls_that_cannot_be_done_change_nothing(call: Any, error: type[Exception], message: str) -> None:
    envs, untouched = aloft.HeightVectorEnv(2, MEASURED), aloft.HeightVectorEnv(2, MEASURED)
    envs.reset(seed=1)
    untouched.reset(seed=1)
    with pytest.raises(error, match=message):
        call(envs)
    assert_same(envs.step(np.array([2, 1])), untouched.step(np.array([2, 1])))


def test_what_cannot_be_made_is_refused() -> None:
    for wrong in ({"num_envs": 0}, {"num_envs": 10**6}, {"num_envs": 2, "num_threads": 5000}):
        with pytest.raises(ValueError, match="num_"):
            aloft.HeightVectorEnv(world=MEASURED, **wrong)
    with pytest.raises(ValueError, match="AutoresetMode"):
        aloft.HeightVectorEnv(2, MEASURED, autoreset_mode="sometimes")
    with pytest.raises(RuntimeError, match=r"call reset\(\) first"):
        aloft.HeightVectorEnv(2, MEASURED).step(np.array([1, 1]))
    envs = aloft.HeightVectorEnv(2, [MEASURED, MEASURED][0], autoreset_mode="Disabled")
    envs.reset(seed=1)
    while not envs.step(np.array([1, 1]))[2].all():
        pass
    with pytest.raises(RuntimeError, match="at its end"):
        envs.step(np.array([1, 1]))


def test_pictures_of_all() -> None:
    envs = aloft.HeightVectorEnv(2, MEASURED, render_mode="rgb_array")
    envs.reset(seed=1)
    frames = envs.render()
    assert frames is not None and [frame.shape for frame in frames] == [(600, 960, 3)] * 2
