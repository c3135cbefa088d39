import inspect
import subprocess
import sys
from pathlib import Path

import gymnasium
from conftest import ROOT

import aloft


def test_import_registers_the_environment() -> None:
    spec = gymnasium.spec("Aloft/Height-v0")
    assert (spec.entry_point, spec.vector_entry_point) == ("aloft:HeightEnv", "aloft:HeightVectorEnv")
    assert spec.max_episode_steps is None


def test_unknown_names_are_attribute_errors() -> None:
    assert not hasattr(aloft, "no_such_name")
    assert "HeightEnv" in dir(aloft)


def test_without_gymnasium_the_package_imports_and_says_what_is_missing() -> None:
    code = """import sys
sys.modules["gymnasium"] = None
import aloft
try:
    aloft.HeightEnv
except ModuleNotFoundError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-P", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "aloft.HeightEnv needs Gymnasium: pip install gymnasium\n"


def test_the_package_is_typed_and_its_types_hold() -> None:
    folder = Path(inspect.getfile(aloft)).parent
    assert (folder / "py.typed").exists()
    assert "class Fleet" in (folder / "_core.pyi").read_text()
    checked = subprocess.run(
        [sys.executable, "-P", "-m", "mypy", "--config-file", ROOT / "python/pyproject.toml", "--cache-dir", "/dev/null", folder],
        capture_output=True,
        text=True,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr
