import copy
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from conftest import CITY, MEASURED, ROOT, SAMPLE, WORLDS
from gymnasium.utils.env_checker import check_env

import aloft
from aloft import _core

VARIANTS: dict[str, dict[str, Any]] = {
    "flat": {},
    "dict": {"observation": "dict"},
    "history": {"history": 3},
    "site map": {"site_map": 5, "observation": "dict"},
    "foresight": {"privileged": True},
    "whole route": {"privileged": "whole-route"},
    "costs": {"energy_weight": 0.01, "handover_cost": 0.5},
}


def fly(env: Any, seed: int, steps: int = 1000) -> list[Any]:
    """Everything that a flight of pseudo-random actions tells."""
    told = [env.reset(seed=seed)]
    actions = np.random.default_rng(seed + 1)
    for _ in range(steps):
        told.append(env.step(actions.integers(3)))
        if told[-1][2]:
            break
    return told


def same(one: Any, other: Any) -> bool:
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(np.array_equal(one, other))


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("world", ["published", "measured"])
def test_the_checker_of_gymnasium_finds_nothing(world: str, variant: str) -> None:
    check_env(aloft.HeightEnv(WORLDS[world], render_mode="ansi", **VARIANTS[variant]), skip_render_check=True)
    check_env(gym.make("Aloft/Height-v0", world=WORLDS[world], **VARIANTS[variant]).unwrapped)


@pytest.mark.parametrize("world", WORLDS)
def test_every_world_flies_to_the_end_of_its_route(world: str) -> None:
    env = aloft.HeightEnv(WORLDS[world])
    told = fly(env, seed=4)
    steps = told[0][1]["steps"]
    assert len(told) == steps + 1
    assert [one[2] for one in told[1:]] == [False] * (steps - 1) + [True]
    assert not any(one[3] for one in told[1:])
    assert all(env.observation_space.contains(one[0]) for one in told)
    assert same(told, fly(aloft.HeightEnv(WORLDS[world]), seed=4))


def test_a_module_name_in_the_id_imports_the_package() -> None:
    code = "import gymnasium; print(gymnasium.make('aloft:Aloft/Height-v0').reset(seed=1)[1])"
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "{'seed': 1, 'trial': 0, 'steps': 100, 'condition': 0}\n"


def test_no_trial_follows_the_last_one() -> None:
    env, envs = aloft.HeightEnv(CITY), aloft.HeightVectorEnv(2, CITY)
    for one in (env, envs):
        one.reset(seed=1, options={"trial": 2**32 - 1})
        with pytest.raises(ValueError, match="there is no trial after 4294967295; reset with another seed"):
            one.reset()
    assert env.step(1)[4]["executed"] == 1  # the flight goes on


def test_conditions_that_differ_in_what_is_foreseen_are_refused_at_once() -> None:
    world = {**CITY, "height_resolution_m": [10, 5]}
    with pytest.raises(ValueError, match="with foresight all conditions must have the same"):
        aloft.HeightEnv(world, privileged=True)
    aloft.HeightEnv(world)


def test_a_seed_begins_at_trial_0_and_each_reset_goes_on() -> None:
    env = aloft.HeightEnv(CITY)
    first, info = env.reset(seed=0)
    assert info == {"seed": 0, "trial": 0, "steps": 100, "condition": 0}
    second, info = env.reset()
    assert (info["seed"], info["trial"]) == (0, 1)
    assert not np.array_equal(first, second)
    again, info = env.reset(options={"trial": 0})
    assert np.array_equal(first, again) and info["trial"] == 0
    assert env.reset()[1]["trial"] == 1
    assert env.reset(options={"trial": 7})[1]["trial"] == 7
    assert env.reset()[1]["trial"] == 8
    assert np.array_equal(env.reset(seed=0)[0], first)
    assert not np.array_equal(env.reset(seed=1)[0], first)
    assert env.reset(seed=2**64 - 1)[1]["seed"] == 2**64 - 1


def test_without_a_seed_the_first_one_is_random_and_told() -> None:
    env, other = aloft.HeightEnv(CITY), aloft.HeightEnv(CITY)
    observation, info = env.reset()
    assert info["seed"] != other.reset()[1]["seed"]
    assert info["trial"] == 0
    assert np.array_equal(observation, other.reset(seed=info["seed"])[0])


def test_a_condition_stays_until_another_one_is_chosen() -> None:
    env = aloft.HeightEnv({**CITY, "bs_density_per_km2": [1, 5]})
    assert env.conditions == ["bs_density_per_km2=1", "bs_density_per_km2=5"]
    sparse = env.reset(seed=1)[0]
    dense, info = env.reset(seed=1, options={"condition": 1})
    assert info["condition"] == 1 and not np.array_equal(sparse, dense)
    assert env.reset()[1] == {"seed": 1, "trial": 1, "steps": 100, "condition": 1}


def test_an_experiment_file_is_flown_as_it_stands(tmp_path: Path) -> None:
    quick = aloft.HeightEnv(str(ROOT / "data/experiments/quick.json"))
    assert quick.conditions[0].endswith("bs_density_per_km2=1") and quick.conditions[-1] == "measured sample"
    quick.reset(seed=1, options={"condition": len(quick.conditions) - 1})
    assert quick.step(1)[4]["qos"] > 1000
    file = tmp_path / "costly.json"
    file.write_text('{"name": "c", "trials": 1, "energy_weight": 0.5, "agents": ["dqn"], "world": {}}')
    costly, free = aloft.HeightEnv(file), aloft.HeightEnv(file, energy_weight=0)
    costly.reset(seed=1), free.reset(seed=1)
    _, reward, _, _, info = costly.step(2)
    assert reward == info["qos"] - 0.5 * info["energy_j"]
    assert free.step(2)[1] == info["qos"]


@pytest.mark.parametrize("variant", VARIANTS)
def test_pickles_and_copies_fly_alike(variant: str) -> None:
    env = aloft.HeightEnv(CITY, **VARIANTS[variant])
    told = fly(env, 3, steps=5)
    for other in (pickle.loads(pickle.dumps(env)), copy.deepcopy(env)):
        assert same(fly(other, 3, steps=5), told)
        assert (other.spec, other.observation_space) == (env.spec, env.observation_space)


def test_the_observation_is_the_report_in_the_documented_order() -> None:
    env = aloft.HeightEnv(CITY, history=1, handover_cost=2.0)
    low, high = env.observation_space.low, env.observation_space.high
    assert np.isfinite(low).all() and np.isfinite(high).all()
    first = env.reset(seed=1)[0]
    parts = aloft.HeightEnv(CITY, history=1, handover_cost=2.0, observation="dict")
    named = parts.reset(seed=1)[0]
    assert list(named) == ["step", "height", "sinr_db", "neighbours_db", "quality", "executed", "reward"]
    assert np.array_equal(np.concatenate(list(named.values())), first)
    assert np.array_equal(named["executed"], [1, 0, 0, 0] * 2)  # none; before the first report, that one
    assert (named["step"] == 0).all() and (named["height"] == 0).all() and (named["reward"] == 0).all()
    for number, (action, executed) in enumerate([(0, 1), (2, 2), (2, 2), (0, 0), (1, 1)], start=1):
        before = named
        named, reward, _, _, info = parts.step(action)
        assert info["executed"] == executed  # down at the lowest height is hold
        assert named["step"] == pytest.approx([number / 100, (number - 1) / 100])
        assert named["height"][0] == pytest.approx((info["height_m"] - 40) / 200)
        assert named["quality"][0] == pytest.approx(info["qos"])
        assert named["reward"][0] == pytest.approx(reward)
        assert reward == info["qos"] - 2.0 * info["handover"]
        assert named["executed"][:4].argmax() == executed + 1
        for name, values in named.items():
            assert np.array_equal(values[len(values) // 2 :], before[name][: len(values) // 2])
    neighbours = named["neighbours_db"][:5]
    assert (np.diff(neighbours) <= 0).all() and neighbours.min() >= -100


def test_a_measured_quality_is_in_mbit_per_s_for_learners() -> None:
    env = aloft.HeightEnv(MEASURED, observation="dict")
    env.reset(seed=1)
    observation, reward, _, _, info = env.step(2)
    assert reward == info["qos"] > 1000  # kbit/s
    assert observation["quality"][0] == pytest.approx(info["qos"] / 1000)
    assert observation["reward"][0] == pytest.approx(reward / 1000)


def test_foresight_is_the_quality_that_comes() -> None:
    one, whole = aloft.HeightEnv(CITY, privileged="next-step"), aloft.HeightEnv(CITY, privileged="whole-route")
    profile = one.reset(seed=5)[1]["profile"]
    profiles = whole.reset(seed=5)[1]["profiles"]
    assert profile.shape == (21,) and profiles.shape == (100, 21)
    for step in range(100):
        assert np.array_equal(profile, profiles[step])
        _, _, terminated, _, info = one.step(step % 3)
        assert info["qos"] == profile[round((info["height_m"] - 40) / 10)]
        assert ("profile" in info) == (not terminated)
        profile = info.get("profile")
        assert "profiles" not in whole.step(step % 3)[4]


def test_the_site_map_shows_the_nearest_sites_from_the_uav() -> None:
    env = aloft.HeightEnv({**CITY, "window_m": 1500}, site_map=30, observation="dict")
    observation = env.reset(seed=2)[0]
    for _ in range(3):
        info = env.step(1)[4]
    observation, _, _, _, info = env.step(1)
    sites = observation["sites"].reshape(30, 5)
    known = sites[sites[:, 4] == 1]
    assert 0 < len(known) < 30
    assert (sites[len(known) :] == 0).all()
    stations = env._settings.worlds.scene(0, 2, 0)["base_stations_m"]
    offsets = (stations - [info["x_m"], info["y_m"]]) / 1000
    nearest = offsets[np.argsort(np.hypot(*offsets.T))]
    assert known[:, :2] == pytest.approx(nearest, abs=1e-6)
    later = env.step(1)[4]
    assert observation["route"] * 1000 == pytest.approx([later["x_m"] - info["x_m"], later["y_m"] - info["y_m"]], abs=1e-3)
    sectors = aloft.HeightEnv({**CITY, "bs_antenna": "sector"}, site_map=3, observation="dict").reset(seed=1)[0]
    assert np.hypot(*sectors["sites"].reshape(3, 5)[:, 2:4].T) == pytest.approx(np.ones(3))


@pytest.mark.parametrize("told", [{}, {"site_map_error_m": 30, "site_map_missing": 0.3}, {"site_map_route_points": 2}])
def test_a_site_map_may_be_wrong_incomplete_or_short_of_sight(told: dict[str, Any]) -> None:
    env = aloft.HeightEnv({**CITY, **told}, site_map=4)
    for observation, *_ in fly(env, seed=1):
        assert env.observation_space.contains(observation)


def test_a_step_tells_energy_and_handovers_as_the_result_database_counts_them() -> None:
    env = aloft.HeightEnv(CITY)
    infos = [told[4] for told in fly(env, seed=6)[1:]]
    cells = [info["serving_cell"] for info in infos]
    assert [info["handover"] for info in infos] == [False, *(a != b for a, b in zip(cells, cells[1:], strict=False))]
    assert sum(info["handover"] for info in infos) > 0
    assert min(info["energy_j"] for info in infos) == pytest.approx(126.029, abs=1e-3)


BAD = [
    ({"world": {"bs_densty_per_km2": 1}}, ValueError, r"world\.bs_densty_per_km2: unknown key.*'bs_density_per_km2'"),
    ({"world": {"bs_density_per_km2": -1}}, ValueError, r"bs_density_per_km2.*-1"),
    ({"world": {"bs_density_per_km2": float("nan")}}, ValueError, r"."),
    ({"world": {"kind": "measured"}}, ValueError, r"file"),
    ({"world": {"kind": "measured", "file": "nowhere.csv"}}, FileNotFoundError, r"nowhere\.csv"),
    ({"world": "nowhere.json"}, FileNotFoundError, r"nowhere\.json"),
    ({"world": str(ROOT)}, ValueError, r"folder"),
    ({"world": SAMPLE}, ValueError, r"line 1"),
    ({"world": 5}, TypeError, r"world: int"),
    ({"world": {"x": object()}}, TypeError, r"serializable"),
    ({"observation": "cube"}, ValueError, r"observation: 'cube'.*flat"),
    ({"history": -1}, ValueError, r"history: -1"),
    ({"history": 10**6}, ValueError, r"history: 1000000.*1024"),
    ({"history": 1.5}, TypeError, r"history: 1\.5"),
    ({"energy_weight": -1.0}, ValueError, r"energy_weight"),
    ({"energy_weight": float("nan")}, ValueError, r"energy_weight"),
    ({"handover_cost": "much"}, ValueError, r"handover_cost: 'much'"),
    ({"privileged": "all"}, ValueError, r"privileged: 'all'.*next-step"),
    ({"render_mode": "human"}, ValueError, r"render_mode: 'human'"),
    ({"world": {"route": "serving"}, "privileged": "whole-route"}, ValueError, r"nearest"),
    ({"world": {"route": "serving"}, "site_map": 2}, ValueError, r"nearest"),
]


@pytest.mark.parametrize(("arguments", "error", "message"), BAD)
def test_arguments_that_cannot_be_used_are_named(arguments: dict[str, Any], error: Any, message: str) -> None:
    with pytest.raises(error, match=message):
        aloft.HeightEnv(**arguments)


def test_a_measured_flight_without_sites_has_no_site_map(tmp_path: Path) -> None:
    alone = tmp_path / "flight.csv"
    alone.write_bytes(Path(SAMPLE).read_bytes())
    with pytest.raises((ValueError, FileNotFoundError), match=re.escape("sites.csv")):
        aloft.HeightEnv({"kind": "measured", "file": str(alone)}, site_map=3)
    assert aloft.HeightEnv(MEASURED, site_map=3).reset(seed=1)[0].shape == (31,)


def test_calls_that_cannot_be_done_are_refused_and_change_nothing() -> None:
    env = aloft.HeightEnv(MEASURED)
    with pytest.raises(RuntimeError, match=r"call reset\(\) first"):
        env.step(1)
    for wrong in ({"seed": -1}, {"seed": 2**64}, {"options": {"trail": 1}}, {"options": {"condition": 1}}):
        with pytest.raises(ValueError, match=r"seed|trail|condition"):
            env.reset(**wrong)
    for mistyped in ({"seed": 1.0}, {"seed": "1"}, {"options": 5}, {"options": {"trial": "0"}}):
        with pytest.raises(TypeError, match=r"seed|options|trial"):
            env.reset(**mistyped)
    env.reset(seed=1)
    for action in (-1, 3, 2**70, -(2**70), 1.0, "up", None, np.array([1, 2]), True):
        with pytest.raises((ValueError, TypeError)):
            env.step(action)
    assert env.step(1)[0][0] == pytest.approx(1 / 60)
    while not env.step(1)[2]:
        pass
    with pytest.raises(RuntimeError, match=r"at its end; call reset\(\)"):
        env.step(1)
    env.reset()
    env.step(np.int64(1))


def test_the_text_tells_step_height_and_quality() -> None:
    env = aloft.HeightEnv(CITY, render_mode="ansi")
    env.reset(seed=1)
    assert "step 0 of 100" in env.render()
    _, _, _, _, info = env.step(2)
    text = env.render()
    assert "step 1 of 100" in text and "height 50 m" in text and f"quality {info['qos']:.2f} bit/s/Hz" in text


@pytest.mark.parametrize("world", ["published", "paper-text", "serving", "measured", "measured with sites"])
def test_the_picture_shows_the_flight(world: str) -> None:
    places = {"sites_file": SAMPLE.replace(".csv", ".sites.csv")}
    env = aloft.HeightEnv(WORLDS.get(world, {**MEASURED, **places}), render_mode="rgb_array")
    env.reset(seed=1)
    empty = env.render()
    assert empty.shape == (600, 960, 3) and empty.dtype == np.uint8
    for _ in range(30):
        env.step(2)
    flown = env.render()
    left, right = np.s_[:, :600], np.s_[:, 600:]
    for half in (left, right):
        assert (empty[half] != flown[half]).any(axis=-1).sum() > 500
    colours = len(np.unique(flown[left].reshape(-1, 3), axis=0))
    assert colours > 30


def test_names_of_the_core_are_those_of_its_columns() -> None:
    env = aloft.HeightEnv(CITY)
    columns = env._fleet.columns()
    for name, kind in (("number", _core.NUMBERS), ("integer", _core.INTEGERS), ("flag", _core.FLAGS)):
        assert len(columns[name]) == len(kind)
