import csv
import io
import shutil
import sqlite3
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, SAMPLE

import aloft
from aloft.results import Table

EXPERIMENT = """{
  "name": "results", "seed": 9, "trials": 2, "energy_weight": 0.001,
  "worlds": [
    {"kind": "generated", "height_resolution_m": 10, "steps": 20, "bs_density_per_km2": [2.5, 5], "bs_antenna": ["array", "sector"]},
    {"kind": "measured", "file": "%s"}
  ],
  "agents": ["min-height", {"type": "dqn", "name": "learner", "epochs": 2}, "one-step-ahead"]
}"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, aloft_program: str) -> Path:
    place = tmp_path_factory.mktemp("results")
    (place / "experiment.json").write_text(EXPERIMENT % SAMPLE)
    run = [aloft_program, "run", place / "experiment.json", "--in-process", "--out", place / "out"]
    subprocess.run(run, check=True, capture_output=True)
    return place / "out"


def check_equals_export(program: str, folder: Path, rows: str, table: Table) -> None:
    """Every column of `aloft export`, value by value."""
    text = subprocess.run([program, "export", rows, folder], check=True, capture_output=True, text=True).stdout
    exported = list(csv.DictReader(io.StringIO(text)))
    assert list(exported[0]) == list(table)
    assert len(exported) == table.rows > 0
    for name in exported[0]:
        values = [row[name] for row in exported]
        if table[name].dtype.kind == "U":
            assert table[name].tolist() == values
        else:
            np.testing.assert_array_equal(table[name], [float(value) if value else np.nan for value in values])


def test_flights_and_steps_are_those_of_aloft_export(aloft_program: str, folder: Path) -> None:
    results = aloft.read(folder)
    check_equals_export(aloft_program, folder, "--flights", results.flights)
    check_equals_export(aloft_program, folder, "--steps", results.steps)
    assert results.flights.rows == 5 * 2 * 3


def test_what_flights_have_in_common_is_in_columns(folder: Path) -> None:
    for table in (aloft.read(folder).flights, aloft.read(str(folder)).steps):
        assert set(zip(table["agent"], table["agent_type"], table["privilege"], strict=True)) == {
            ("min-height", "min-height", "none"),
            ("learner", "dqn", "none"),
            ("one-step-ahead", "one-step-ahead", "next-step"),
        }
        generated = table["qos_unit"] == "bit/s/Hz"
        assert set(table["seed"].tolist()) == {9}
        assert set(table["bs_density_per_km2"][generated].tolist()) == {2.5, 5.0}
        assert np.isnan(table["bs_density_per_km2"][~generated]).all()
        assert set(table["bs_antenna"][generated].tolist()) == {"array", "sector"}
        assert set(table["bs_antenna"][~generated].tolist()) == {""}
        for density, antenna, name in zip(
            table["bs_density_per_km2"][generated], table["bs_antenna"][generated], table["condition"][generated], strict=True
        ):
            assert f"{density:g}" in name and antenna in name


def test_types_of_columns(folder: Path) -> None:
    results = aloft.read(folder)
    kinds = {name: column.dtype.kind for name, column in results.flights.items()}
    assert kinds["height_changes"] == kinds["trial"] == "i"
    assert kinds["handovers"] == kinds["qos_mean"] == "f"
    assert results.steps["action"].dtype.kind == "U"
    assert results.experiment["name"] == "results"
    with pytest.raises(KeyError, match="there is no column 'height'; there are condition, "):
        results.flights["height"]


def test_to_pandas_and_polars(folder: Path, tmp_path: Path) -> None:
    table = aloft.read(folder).flights
    pandas = pytest.importorskip("pandas")
    frame = table.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == list(table)
    means = frame.groupby("agent")["qos_mean"].mean()
    assert means["learner"] == pytest.approx(table["qos_mean"][table["agent"] == "learner"].mean())
    polars = pytest.importorskip("polars")
    assert isinstance(table.to_polars(), polars.DataFrame)
    assert table.to_polars()["digest"].to_list() == table["digest"].tolist()
    # What `aloft export --format parquet` says to do instead.
    for columns in (table, aloft.read(folder).steps):
        columns.to_polars().write_parquet(tmp_path / "table.parquet")
        back = polars.read_parquet(tmp_path / "table.parquet")
        assert back.columns == list(columns)
        for name in columns:
            assert np.array_equal(back[name].to_numpy(), columns[name], equal_nan=columns[name].dtype.kind == "f")


def test_an_old_folder_is_read(aloft_program: str, tmp_path: Path) -> None:
    old = shutil.copytree(ROOT / "tests/golden/results-0.2.0/interrupted", tmp_path / "old")
    results = aloft.read(old)
    assert results.flights.rows == 21
    check_equals_export(aloft_program, old, "--flights", results.flights)


def refused(folder: Path, kind: type[Exception]) -> str:
    with pytest.raises(kind) as refusal:
        aloft.read(folder)
    assert type(refusal.value) is kind
    assert str(folder) in str(refusal.value)
    return str(refusal.value)


def test_a_folder_without_results_is_refused(tmp_path: Path) -> None:
    assert "results.sqlite" in refused(tmp_path / "nothing", FileNotFoundError)
    assert "results.sqlite" in refused(tmp_path, FileNotFoundError)
    (tmp_path / "results.sqlite").write_text("no database")
    assert "is damaged" in refused(tmp_path, ValueError)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("PRAGMA user_version = 99", "has format 99, this program reads format"),
        ("PRAGMA application_id = 1", "results.sqlite"),
        ("DELETE FROM trace WHERE flight = 3", "Restore the folder from a copy"),
    ],
)
def test_another_version_or_damage_is_refused(folder: Path, tmp_path: Path, change: str, message: str) -> None:
    copy = shutil.copytree(folder, tmp_path / "copy")
    database = sqlite3.connect(copy / "results.sqlite")
    database.execute(change)
    database.commit()
    database.close()
    assert message in refused(copy, ValueError)


def test_a_changed_number_is_noticed_when_it_is_read(folder: Path, tmp_path: Path) -> None:
    copy = shutil.copytree(folder, tmp_path / "copy")
    database = sqlite3.connect(copy / "results.sqlite")
    database.execute("UPDATE flight SET qos_mean = qos_mean + 1 WHERE id = 2")
    database.commit()
    database.close()
    with pytest.raises(ValueError, match="is damaged"):
        aloft.read(copy).flights  # noqa: B018
