"""examples/python: a policy is trained, flown by two workers, and shown in the report. min_height.py: test_dds_runs.py."""

import json
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT

import aloft

pytestmark = pytest.mark.runs

EXAMPLES = ROOT / "examples/python"
sys.path.insert(0, str(EXAMPLES))

import train_ppo  # noqa: E402


@pytest.fixture(autouse=True)
def limit() -> Iterator[None]:
    """What the run printed says whom it waits for."""

    def late(*_: Any) -> None:
        pytest.fail("the example has not ended in 300 s; on an idle machine it takes 10 s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(300)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture
def place(aloft_program: str) -> dict[str, Any]:
    return {"program": aloft_program, "run": f"examples-{os.getpid()}", "domain": 10 + os.getpid() % 90}


def test_a_policy_is_flown_by_two_workers_beside_agents_of_aloft(
    place: dict[str, Any], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    train_ppo.fly([sys.executable, ROOT / "python/tests/flying_agents.py", "half-way"], out, 2, **place)
    results = aloft.read(out)
    assert set(results.flights["agent"]) == {"min-height", "height-filter", "pretrained", "ppo"}
    flown = results.steps["agent"] == "ppo"
    assert set(results.steps["height_m"][flown & (results.steps["step"] >= 10)]) == {140.0}
    assert "ppo" in (out / "report.html").read_text()
    capfd.readouterr()
    train_ppo.show(out)
    lines = capfd.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines[1:]] == ["min-height", "height-filter", "pretrained", "ppo"]
    assert lines[1].split()[1:] == ["+0.00"] * 5


def test_an_agent_that_ends_too_early_ends_the_run(place: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="an agent has ended before the run"):
        train_ppo.fly([sys.executable, "-c", "raise SystemExit(3)"], tmp_path / "out", 2, **place)


def test_the_notebook_trains_and_flies(place: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("torch", reason="Stable-Baselines3 needs PyTorch (Debian: python3-torch)", exc_type=ImportError)
    pytest.importorskip("stable_baselines3", exc_type=ImportError)
    monkeypatch.chdir(tmp_path)
    cells = json.loads((EXAMPLES / "train_ppo.ipynb").read_text())["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    values: dict[str, Any] = {}
    for cell in code:
        exec(compile(cell, "train_ppo.ipynb", "exec"), values)
        if "STEPS" in cell:  # the cell of settings, with smaller ones
            values.update(STEPS=10_000, TRIALS=1, PLACE=place)
    flights = aloft.read(tmp_path / "results/ppo").flights
    assert flights.rows == 5 * 4
    assert np.isfinite(flights["qos_mean"]).all()
