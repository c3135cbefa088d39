import os
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
SAMPLE = str(ROOT / "data/samples/measured_sample.csv")

MEASURED: dict[str, Any] = {"kind": "measured", "file": SAMPLE}
#: Worlds that are made quickly, and differ in every kind of choice.
WORLDS: dict[str, dict[str, Any]] = {
    "published": {"height_resolution_m": 10, "bs_density_per_km2": 3},
    "paper-text": {"preset": "paper-text", "height_resolution_m": 10, "building_density_per_km2": 50},
    "geometric": {"preset": "geometric", "height_resolution_m": 10, "building_density_per_km2": 50},
    "serving": {"route": "serving", "height_resolution_m": 10, "building_density_per_km2": 50},
    "measured": MEASURED,
}
CITY = WORLDS["published"]


@pytest.fixture(scope="session")
def aloft_program() -> str:
    """The C++ host's program; its folder is in ALOFT_BIN."""
    program = Path(os.environ.get("ALOFT_BIN", ROOT / "build/bin"), "aloft")
    if not program.exists():
        pytest.skip(f"there is no {program}; build it, or name its folder in ALOFT_BIN")
    return str(program)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Says why tests were skipped as all tests of Aloft do (tools/run_ctest.sh)."""
    reasons = {report.longrepr[2].removeprefix("Skipped: ") for report in terminalreporter.getreports("skipped")}
    for reason in sorted(reasons):
        terminalreporter.write_line(f"SKIPPED: {reason}")
