"""Labelled data sets over sweeps of a scenario, and windows of them to learn from."""

from __future__ import annotations

import csv
import itertools
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _toml
from ._command import document, flag, option
from ._progress import Progress
from .errors import InvalidInput
from .run_file import RunFile
from .scenarios import Scenario

if TYPE_CHECKING:
    import pandas as pd

CLASSES = ("ALCT", "SLCT", "LEIS", "UWTIC")
"""Classes of wheel-terrain interaction, in the order of their numbers in a data set."""


def sweep(scenario: Scenario, *, repeats: int = 1, seed: int = 1, **keys: Sequence[Any]) -> Sweep:
    """Every combination of the values of `keys`, each `repeats` times on other random ground.

    Args:
        scenario: what is varied.
        repeats: runs under each condition.
        seed: of all randomness.
        keys: short or full keys (see `lugwheel.scenario`) to their values in SI units.

    Raises:
        InvalidInput: there is no such key.
    """
    full = {scenario.key(short): list(values) for short, values in keys.items()}
    return Sweep(scenario, full, repeats, seed)


@dataclass(frozen=True)
class Sweep:
    """Conditions of a scenario and how often each is run."""

    scenario: Scenario
    keys: Dict[str, List[Any]]
    repeats: int
    seed: int

    @property
    def conditions(self) -> List[Dict[str, Any]]:
        """Keys and values of each condition."""
        return [dict(zip(self.keys, values)) for values in itertools.product(*self.keys.values())]

    def __len__(self) -> int:
        return len(self.conditions) * self.repeats

    def scenarios(self) -> List[Scenario]:
        """The scenario of each condition."""
        return [self.scenario.edited(condition) for condition in self.conditions]

    def study(self, scenario_file: str) -> str:
        """Text of the study file that makes the data set."""
        names = ", ".join(self.keys) or "repeats"
        head = {
            "version": 1,
            "title": f"{self.scenario.name} over {names}",
            "question": f"Which classes do runs of {self.scenario.name} over {names} hold?",
            "scenarios": [scenario_file],
            "seed": self.seed,
            "repeats": self.repeats,
            "random_numbers": "independent",
        }
        sweeps = [f"\n[[sweep]]\n{_toml.table({'key': key, 'values': v})}" for key, v in self.keys.items()]
        return _toml.table(head) + "".join(sweeps) + '\n[dataset]\nkeep = "traces"\n'

    def dataset(
        self,
        folder: Union[str, os.PathLike],
        *,
        jobs: Optional[int] = None,
        resume: bool = False,
        force: bool = False,
        progress: Progress = False,
    ) -> DataSet:
        """Simulates all runs into a folder, with labels, splits without leakage, datasheet and metadata.

        Beside the folder stand `<folder>.toml` (the study, which `lugwheel study` runs too) and
        `<folder>.scenario.toml`. After Ctrl-C or a kill, `resume=True` goes on from the runs that are whole.

        Args:
            folder: where to.
            jobs: runs at a time; all cores unless given.
            resume: go on with what the folder holds.
            force: replace it.
        """
        folder = Path(folder)
        folder.parent.mkdir(parents=True, exist_ok=True)
        scenario, study = (folder.with_name(f"{folder.name}{end}") for end in (".scenario.toml", ".toml"))
        for path, text in ((scenario, self.scenario.text), (study, self.study(scenario.name))):
            _write(path, text, force)
        words = ["study", study, "--out", folder, *option("--jobs", jobs)]
        document([*words, *flag("--resume", resume), *flag("--force", force)], progress=progress)
        return DataSet(folder)


def _write(path: Path, text: str, force: bool) -> None:
    """Writes a text where there is none, or the same one."""
    if path.exists() and not force and path.read_text(encoding="utf-8") != text:
        raise InvalidInput(f"{path} describes another data set; name another folder, or force=True")
    path.write_text(text, encoding="utf-8")


class DataSet:
    """A labelled data set in a folder: runs, windows, splits."""

    def __init__(self, folder: Union[str, os.PathLike]) -> None:
        self.folder = Path(folder)
        self.runs = RunFile(self.folder / "dataset.h5")

    def __len__(self) -> int:
        return len(self.runs)

    @property
    def windows(self) -> pd.DataFrame:
        """A row for each labelled window: condition, class, features, part under each split."""
        import pandas as pd

        return pd.read_csv(self.folder / "dataset.windows.csv")

    @property
    def splits(self) -> pd.DataFrame:
        """The part (train, validation, test) of each run by run, ground, condition and both."""
        import pandas as pd

        return pd.read_csv(self.folder / "dataset.splits.csv", index_col="run")

    def torch(
        self,
        part: str = "train",
        *,
        split: str = "by_ground",
        window: Optional[float] = None,
        channels: Sequence[str] = ("acceleration_y",),
    ) -> WindowDataset:
        """Windows of one part for `torch.utils.data.DataLoader`: samples [channel, time] and class number.

        Args:
            part: `train`, `validation` or `test`.
            split: what the parts do not share: `by_run`, `by_ground`, `by_condition` or `by_both`.
            window: length [s]; that of the labelled windows unless given, which are cut into shorter ones.
            channels: of one sample rate.

        Raises:
            InvalidInput: the data set has no such split or part; a window longer than those labelled.
        """
        labelled = self._labelled(part, split)
        cut = [piece for row in labelled for piece in _cut(row, window)]
        if not cut:
            raise InvalidInput(f"no labelled window is as long as {window} s")
        return WindowDataset(self.runs.path, cut, tuple(channels))

    def _labelled(self, part: str, split: str) -> List[Dict[str, str]]:
        with (self.folder / "dataset.windows.csv").open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        splits = [column for column in rows[0] if column.startswith("by_")] if rows else []
        if split not in splits:
            raise InvalidInput(f"there is no split {split!r}; there are {', '.join(splits)}")
        found = [row for row in rows if row[split] == part]
        if not found:
            parts = sorted({row[split] for row in rows} - {""})
            has = f"it has {', '.join(parts)}" if parts else "the data set is too small for it"
            raise InvalidInput(f"split {split} has no part {part!r}; {has}")
        return found

    def __repr__(self) -> str:
        return f"<lugwheel data set {self.folder}: {len(self)} runs>"


@dataclass(frozen=True)
class Window:
    """A labelled stretch of a run."""

    run: str
    start: float
    """[s]"""
    end: float
    """[s]"""
    label: int
    """Number of the class in `CLASSES`."""


def _cut(row: Dict[str, str], length: Optional[float]) -> List[Window]:
    """Windows of `length` [s] within a labelled one."""
    start, end = float(row["start_s"]), float(row["end_s"])
    label = CLASSES.index(row["class"])
    if length is None:
        return [Window(row["run"], start, end, label)]
    count = int((end - start) / length + 1e-9)
    return [
        Window(row["run"], start + number * length, start + (number + 1) * length, label)
        for number in range(count)
    ]


class WindowDataset:
    """A map-style data set, as `torch.utils.data.DataLoader` takes: samples (float32) and class number.

    Each worker process opens the file for itself and keeps the run it read last.
    """

    def __init__(self, path: Path, windows: List[Window], channels: Tuple[str, ...]) -> None:
        self.path = path
        self.windows = windows
        self.channels = channels
        self._process: Optional[int] = None
        self._file: Optional[RunFile] = None
        self._last: Tuple[Optional[str], Any] = (None, None)

    def __len__(self) -> int:
        return len(self.windows)

    def __getitem__(self, index: int) -> Tuple[np.ndarray, int]:
        window = self.windows[index]
        channels = [self._run(window.run).channel(name) for name in self.channels]
        first = channels[0]
        if any(channel.sample_rate != first.sample_rate for channel in channels):
            raise InvalidInput(f"{', '.join(self.channels)} have several sample rates; choose those of one")
        begin = max(0, round((window.start - first.start) * first.sample_rate))
        count = round((window.end - window.start) * first.sample_rate)
        samples = [channel.samples[begin : begin + count] for channel in channels]
        return np.stack(samples).astype(np.float32), window.label

    def _run(self, id: str) -> Any:
        if self._file is None or self._process != os.getpid():
            self._process, self._file, self._last = os.getpid(), RunFile(self.path), (None, None)
        if self._last[0] != id:
            self._last = (id, self._file[id])
        return self._last[1]

    def __getstate__(self) -> Dict[str, Any]:
        return {**self.__dict__, "_process": None, "_file": None, "_last": (None, None)}

    def __repr__(self) -> str:
        return f"<lugwheel windows of {', '.join(self.channels)}: {len(self)}>"
