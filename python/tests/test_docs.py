"""What docs/python.md shows and says."""

import inspect
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from conftest import CITY, MEASURED, ROOT

import aloft
from aloft import _core

TEXT = (ROOT / "docs/python.md").read_text()
SAMPLES = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)


@pytest.fixture(autouse=True)
def in_a_folder_as_the_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With results, as after a run."""
    (tmp_path / "data").symlink_to(ROOT / "data")
    shutil.copytree(ROOT / "tests/golden/results-0.2.0/interrupted", tmp_path / "results/bs-density")
    monkeypatch.chdir(tmp_path)


def table(heading: str) -> list[list[str]]:
    section = TEXT.split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


@pytest.mark.parametrize("number", range(len(SAMPLES)))
def test_samples_run(number: int) -> None:
    if "stable_baselines3" in SAMPLES[number]:
        pytest.importorskip("torch", reason="Stable-Baselines3 needs PyTorch (Debian: python3-torch)", exc_type=ImportError)
    names: dict[str, Any] = {}
    exec(SAMPLES[0], names)  # the imports of the first one
    exec(SAMPLES[number], names)


def test_there_are_samples() -> None:
    assert len(SAMPLES) == 6


def test_the_layout_of_observations_is_the_real_one() -> None:
    rows = []
    for name, values, bounds, _ in table("Observations"):
        low, high = map(float, bounds.split(" to "))
        rows.append((name.strip("`"), int(values), low, high))
    assert rows == _core.REPORT_FIELDS
    for name, *_ in _core.SITE_FIELDS:
        assert f"`{name}`" in TEXT


def test_the_keys_of_infos_are_the_real_ones() -> None:
    documented = {when: re.findall(r"`(\w+)`", keys) for when, keys in table("Infos")}
    env = aloft.HeightEnv(CITY)
    assert documented["reset"] == list(env.reset(seed=1)[1])
    assert sorted(documented["step"]) == sorted(env.step(1)[4])
    for value, key in (("next-step", "profile"), ("whole-route", "profiles")):
        assert documented[f'`privileged="{value}"`'] == [key]
        assert key in aloft.HeightEnv(MEASURED, privileged=value).reset(seed=1)[1]


def test_the_arguments_are_the_real_ones() -> None:
    parameters = inspect.signature(aloft.HeightEnv).parameters
    defaults = {name: one.default for name, one in parameters.items() if name != "world"}
    documented = {
        name: eval(default.strip("`"))
        for names, default, _ in table("An environment")
        for name in re.findall(r"`(\w+)`", names)
    }
    assert documented == defaults
