"""Scenarios: one experiment each, with checked keys."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Union

from . import _native, _toml
from ._command import document
from ._progress import Progress, listener
from .errors import InvalidInput
from .run import Run

if TYPE_CHECKING:
    import pandas as pd


def scenarios() -> List[str]:
    """Names of the scenarios that are part of the package."""
    return [name for name, _ in _native.ready_scenarios()]


def keys(prefix: Optional[str] = None) -> pd.DataFrame:
    """Keys of scenarios: unit, range, default, meaning; those that begin with `prefix`, or have it anywhere.

    Raises:
        InvalidInput: no key has it; the message names those like it.
    """
    import pandas as pd

    tables = document(["keys", *([] if prefix is None else [prefix])])
    return pd.DataFrame([key for table in tables for key in table["keys"]]).set_index("path")


def scenario(
    name: Union[str, os.PathLike],
    keys: Optional[Mapping[str, Any]] = None,
    *,
    effects: Optional[Mapping[str, float]] = None,
    **short_keys: Any,
) -> Scenario:
    """The scenario of a file, or the ready one of this name, with keys set.

    Args:
        name: a file, or a name of `scenarios()`.
        keys: full keys to values in SI units, as `{"rig.single_wheel.slip": 0.3}`.
        effects: departures from the ideal rig, name to magnitude, as `{"gain_error.drawbar_pull": 0.05}`.
        short_keys: the last part of a key where only one key ends so (`slip=0.3`), or a key with `__` in
            place of dots (`wheel__lugs__count=24`).

    Raises:
        InvalidInput: there is no such scenario or key, or a value is out of its range.
    """
    ready = dict(_native.ready_scenarios())
    path = Path(name)
    if path.is_file():
        text, file = path.read_text(encoding="utf-8"), str(path)
    elif str(name) in ready:
        text, file = ready[str(name)], f"{name}.toml"
    else:
        raise InvalidInput(f"there is no scenario {str(name)!r}: no file, and none of {', '.join(ready)}")
    found = Scenario(_native.Scenario(text, file, []), path.stem)
    return found.edited(keys, effects=effects, **short_keys)


class Scenario(Mapping):
    """One experiment: ground, wheel, rig and sensors. A mapping of its full keys to their values in SI units.

    It never changes: `edited` returns another one.
    """

    def __init__(self, native: _native.Scenario, name: str) -> None:
        self._native = native
        self.name = name

    def edited(
        self,
        keys: Optional[Mapping[str, Any]] = None,
        *,
        effects: Optional[Mapping[str, float]] = None,
        **short_keys: Any,
    ) -> Scenario:
        """This scenario with keys set and effects added, as in `scenario()`."""
        full = {**(keys or {}), **{self.key(short): value for short, value in short_keys.items()}}
        full.update({f"effect.{name}": size for name, size in (effects or {}).items()})
        if not full:
            return self
        assignments = [f"{key}={_toml.value(value)}" for key, value in full.items()]
        return Scenario(self._native.with_all(assignments), self.name)

    def key(self, short: str) -> str:
        """The full key of a short one: of `slip`, `rig.single_wheel.slip`.

        Raises:
            InvalidInput: several keys end so.
        """
        dotted = short.replace("__", ".")
        if dotted in self._flat:
            return dotted
        ending = [key for key in self._flat if key.endswith(f".{dotted}")]
        if len(ending) > 1:
            raise InvalidInput(f"{short!r} may be {', '.join(ending)}: write one of them, with __ for the dots")
        return ending[0] if ending else dotted

    @property
    def text(self) -> str:
        """The scenario as a TOML text, with its comments."""
        return self._native.text

    @cached_property
    def values_by_table(self) -> Dict[str, Any]:
        """All values, defaults included, as nested dictionaries."""
        return json.loads(self._native.values)

    @cached_property
    def _flat(self) -> Dict[str, Any]:
        return dict(_flattened(self.values_by_table, ""))

    def __getitem__(self, key: str) -> Any:
        return self._flat[self.key(key)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._flat)

    def __len__(self) -> int:
        return len(self._flat)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scenario) and self.text == other.text

    __hash__ = None  # type: ignore[assignment]

    def _ipython_key_completions_(self) -> List[str]:
        return list(self._flat)

    def run(self, seed: int = 1, run: int = 0, *, progress: Progress = False) -> Run:
        """Simulates one run: run number `run` of the series that `seed` begins.

        The same scenario, seed and number give the same bits, here, in the program and in a data set.

        Raises:
            Failed: the motion is not defined, as where the ground does not carry the wheel.
            KeyboardInterrupt: Ctrl-C.
        """
        native = self._native.run(seed, run, listener(progress))
        return Run(native, f"run_{run:06d}", scenario=self.text, seed=seed)

    def save(self, path: Union[str, os.PathLike]) -> Path:
        """Writes the scenario to a file, which must not be there yet."""
        path = Path(path)
        with path.open("x", encoding="utf-8") as file:
            file.write(self.text)
        return path

    def __repr__(self) -> str:
        return f"<lugwheel scenario {self.name}: {len(self)} keys, {self.values_by_table['duration']:g} s>"


def _flattened(values: Mapping[str, Any], prefix: str) -> Iterator[tuple]:
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flattened(value, f"{prefix}{name}.")
        elif name != "version" or prefix:
            yield f"{prefix}{name}", value
