"""Results of ``aloft run`` as columns of NumPy arrays.

>>> import aloft
>>> results = aloft.read("results/bs-density")  # doctest: +SKIP
>>> results.flights["qos_mean"]                 # doctest: +SKIP
>>> results.steps.to_pandas()                   # doctest: +SKIP
"""

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aloft import _core

__all__ = ["Results", "Table", "read"]

# Columns of steps, in the order of `aloft export --steps`.
_STEPS = (
    *("step", "action", "flown_by", "x_m", "y_m", "height_m", "serving_cell", "serving_sinr_db", "qos", "reward"),
    *("energy_j", "epsilon", "loss", "q_down", "q_hold", "q_up"),
)
_ACTIONS = ("none", "down", "hold", "up", "absolute")


def read(folder: str | os.PathLike[str]) -> "Results":
    """Opens a result folder, of a finished run or of one that is still going on.

    Raises FileNotFoundError if there are no results, and ValueError if they are damaged or of an unknown format.
    """
    return Results(folder)


class Table(Mapping[str, NDArray[Any]]):
    """Columns of the same length, by name."""

    def __init__(self, columns: dict[str, NDArray[Any]]) -> None:
        self._columns = columns

    def __getitem__(self, name: str) -> NDArray[Any]:
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"there is no column {name!r}; there are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        """The number of columns."""
        return len(self._columns)

    @property
    def rows(self) -> int:
        return len(next(iter(self._columns.values())))

    def __repr__(self) -> str:
        return f"<{self.rows} rows of {', '.join(self._columns)}>"

    def to_pandas(self) -> Any:
        """A pandas.DataFrame."""
        import pandas

        return pandas.DataFrame(self._columns)

    def to_polars(self) -> Any:
        """A polars.DataFrame."""
        import polars

        return polars.DataFrame(self._columns)


class Results:
    """A result folder: its flights and their steps, with what they have in common in columns of their own.

    These are ``condition``, one column for every swept parameter, ``seed``, ``trial``, ``agent``, ``agent_type``,
    ``privilege`` and ``qos_unit``. A parameter that a condition does not have is NaN there, or "".
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)
        try:
            self._core = _core.Results.open(self.folder)
        except ValueError as error:
            if os.path.exists(os.path.join(self.folder, "results.sqlite")):
                raise
            raise FileNotFoundError(str(error)) from None
        #: The resolved experiment, every default filled in.
        self.experiment: dict[str, Any] = json.loads(self._core.experiment)

    def __repr__(self) -> str:
        return f"aloft.read({self.folder!r})"

    @cached_property
    def flights(self) -> Table:
        """One row per flight, in the order of conditions, trials and agents: the metrics of table ``flight``."""
        columns, digests = self._core.flights()
        return Table({**self._keys(columns), **_named(columns, _core.METRICS), "digest": np.array(digests, dtype="U64")})

    @cached_property
    def steps(self) -> Table:
        """One row per step of every flight; what a learner thought is NaN for other agents."""
        columns, pilots = self._core.steps()
        columns["action"] = _texts(_ACTIONS, columns["action"])
        columns["flown_by"] = _texts(pilots, columns["flown_by"])
        return Table({**self._keys(columns), **_named(columns, _STEPS)})

    def _keys(self, columns: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        names, parameters, units = zip(*self._core.conditions, strict=True)
        agents, types, privileges = zip(*self._core.agents, strict=True)
        condition, agent = columns["condition"], columns["agent"]
        return {
            "condition": _texts(names, condition),
            **{name: values[condition] for name, values in _swept([json.loads(one) for one in parameters]).items()},
            "seed": np.full(len(condition), self._core.seed, dtype=np.uint64),
            "trial": columns["trial"],
            "agent": _texts(agents, agent),
            "agent_type": _texts(types, agent),
            "privilege": _texts(privileges, agent),
            "qos_unit": _texts(units, condition),
        }


def _texts(names: Sequence[str], numbers: NDArray[Any]) -> NDArray[Any]:
    texts: NDArray[Any] = np.array(names, dtype=str)[numbers]
    return texts


def _named(columns: dict[str, NDArray[Any]], names: Sequence[str]) -> dict[str, NDArray[Any]]:
    return {name: columns[name] for name in names}


def _swept(conditions: list[dict[str, Any]]) -> dict[str, NDArray[Any]]:
    """For every swept parameter its value in each condition."""
    swept = {}
    for name in dict.fromkeys(name for parameters in conditions for name in parameters):
        values = [parameters.get(name) for parameters in conditions]
        if all(value is None or (isinstance(value, (int, float)) and not isinstance(value, bool)) for value in values):
            swept[name] = np.array([np.nan if value is None else value for value in values])
        else:
            swept[name] = np.array([_text(value) for value in values])
    return swept


def _text(value: Any) -> str:
    if isinstance(value, str):
        return value
    return "" if value is None else json.dumps(value)
