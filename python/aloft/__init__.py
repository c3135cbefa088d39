"""Height control of cellular-connected UAVs: the simulator Aloft as Gymnasium environments.

Importing this package registers ``Aloft/Height-v0``. What needs a library that is not installed says so when it is used:
the environments need Gymnasium, :mod:`aloft.sb3` Stable-Baselines3, :mod:`aloft.dds` Cyclone DDS.
"""

import importlib
from typing import Any

_HOME = {
    "HeightEnv": "aloft.env",
    "HeightVectorEnv": "aloft.vector",
    "read": "aloft.results",
}

__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        value = getattr(importlib.import_module(_HOME[name]), name)
    except ModuleNotFoundError as error:
        if error.name != "gymnasium":
            raise
        raise ModuleNotFoundError(f"aloft.{name} needs Gymnasium: pip install gymnasium", name="gymnasium") from None
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})


def _register() -> None:
    try:
        import gymnasium
    except ModuleNotFoundError:  # aloft.read and aloft.dds do without it
        return
    gymnasium.register(
        "Aloft/Height-v0", entry_point="aloft:HeightEnv", vector_entry_point="aloft:HeightVectorEnv"
    )


_register()
