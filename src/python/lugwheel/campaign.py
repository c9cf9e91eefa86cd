"""Measured runs from tables in memory."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterable, Mapping, Optional, Union

from . import _toml
from ._command import document, flag
from .errors import InvalidInput
from .run_file import RunFile

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Wheel:
    """A wheel with lugs."""

    radius: float
    """Rim radius [m]."""
    width: float
    """Width [m]."""
    lugs: Optional[int] = None
    """Number of lugs; 0 on a smooth wheel, None where it is unknown."""
    lug_height: Optional[float] = None
    """Height of a lug [m]."""
    lug_thickness: Optional[float] = None
    """Thickness of a lug along the circumference [m]."""
    mass: Optional[float] = None
    """Mass on the wheel's side of the force sensors [kg]."""

    def _table(self) -> Dict[str, Any]:
        table = {
            "radius_m": self.radius,
            "width_m": self.width,
            "lug_count": self.lugs,
            "lug_height_m": self.lug_height,
            "lug_thickness_m": self.lug_thickness,
            "mass_kg": self.mass,
        }
        return {key: value for key, value in table.items() if value is not None}


@dataclass(frozen=True)
class MeasuredRun:
    """A table of one run and the condition under which it was measured."""

    data: pd.DataFrame
    """A column per quantity; time is the index, or the column `time_s` [s]."""
    load: Optional[float] = None
    """Commanded load [N]."""
    speed: Optional[float] = None
    """Commanded forward speed [m/s]."""
    slip: Optional[float] = None
    """Commanded slip ratio [-]."""
    columns: Mapping[str, Any] = field(default_factory=dict)
    """Channel to column, or to a table as in a campaign file: `{"acceleration_y": {"column": "az",
    "unit": "g", "subtract": 1.0}}`. Columns that have a channel's name and SI unit need none."""
    terrain: Optional[str] = None
    """Label: REF, HT, GT, ST, HGT or SGT."""
    wheel: Optional[Wheel] = None
    """Its wheel, where it is not that of the campaign."""
    id: Optional[str] = None
    """Its name."""
    more: Mapping[str, Any] = field(default_factory=dict)
    """Other keys of a run of a campaign file, as `day`, `repeat`, `notes`, `resample_hz` or `slip_radius`."""


CHANNELS = (
    "acceleration_y",
    "normal_force",
    "drawbar_pull",
    "driving_torque",
    "sinkage",
    "slip_ratio",
    "wheel_angle",
    "wheel_speed",
    "forward_speed",
)
"""Channels that a table may hold by these names, in SI units."""


def campaign(
    runs: Iterable[MeasuredRun],
    wheel: Optional[Wheel] = None,
    *,
    out: Optional[Union[str, os.PathLike]] = None,
    force: bool = False,
) -> RunFile:
    """Measured runs, checked as `lugwheel import` checks files: units, times, gaps, slip.

    Args:
        runs: the runs.
        wheel: the wheel of runs that do not state their own.
        out: run file to write; without one it is deleted with the object returned.
        force: replace an existing run file.

    Raises:
        InvalidInput: a table is not what it should be; the message names run, column and row.
    """
    folder = tempfile.TemporaryDirectory(prefix="lugwheel-")
    inputs = Path(folder.name)
    entries = [_entry(run, number, wheel, inputs) for number, run in enumerate(runs)]
    if not entries:
        raise InvalidInput("a campaign has at least one run")
    description = inputs / "campaign.toml"
    description.write_text("version = 1\n" + "".join(entries), encoding="utf-8")
    target = inputs / "campaign.h5" if out is None else Path(out)
    document(["import", description, "--out", target, *flag("--force", force)])
    return RunFile(target, folder if out is None else None)


def _entry(run: MeasuredRun, number: int, wheel: Optional[Wheel], folder: Path) -> str:
    """Writes the table of a run; the run's part of the campaign file."""
    table = _with_time(run.data)
    columns: Dict[str, Any] = {name: name for name in CHANNELS if name in table}
    columns.update({"time_s": "time_s", **run.columns})
    file = f"{run.id or f'run_{number:06d}'}.csv"
    table.to_csv(folder / file, index=False)
    own = run.wheel or wheel
    keys = {
        "file": file,
        "id": run.id or f"run_{number:06d}",
        "columns": columns,
        "wheel": own and own._table(),
        "load_n": run.load,
        "speed_m_s": run.speed,
        "slip_ratio": run.slip,
        "terrain": run.terrain,
        **run.more,
    }
    return f"\n[[run]]\n{_toml.table(keys)}"


def _with_time(data: pd.DataFrame) -> pd.DataFrame:
    """The table with its times [s] in the column `time_s`."""
    if "time_s" in data:
        return data
    table = data.reset_index(drop=True)
    index = data.index
    if hasattr(index, "tz"):
        index = index - index[0]
    seconds = index.total_seconds() if hasattr(index, "total_seconds") else index
    table.insert(0, "time_s", list(seconds))
    return table
