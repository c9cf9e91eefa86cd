"""Run files, simulated and measured, and what can be asked of them."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable, Iterator, List, Mapping, Optional, Union

from . import _native
from ._command import Word, document, flag, option, repeated
from ._progress import Progress
from .identification import Identification
from .inspection import Inspection
from .recognition import Recognition
from .run import Run

if TYPE_CHECKING:
    import pandas as pd

    from .diagnosis import Diagnosis
    from .scenarios import Scenario


class RunFile:
    """The runs of an HDF5 file: `file[0]` or `file["run_000000"]` reads one."""

    def __init__(
        self, path: Union[str, os.PathLike], folder: Optional[tempfile.TemporaryDirectory] = None
    ) -> None:
        self.path = Path(path)
        self._native = _native.RunFile(self.path)
        # A folder that is deleted with this object.
        self._folder = folder

    @property
    def ids(self) -> List[str]:
        """Names of the runs."""
        return self._native.runs

    @property
    def scenario(self) -> Optional[str]:
        """Text of the scenario that was simulated; None of measured runs."""
        return self._native.scenario

    @property
    def seed(self) -> Optional[int]:
        """Seed of a simulation."""
        return self._native.seed

    def __len__(self) -> int:
        return len(self.ids)

    def __iter__(self) -> Iterator[Run]:
        return (self[id] for id in self.ids)

    def __getitem__(self, run: Union[int, str]) -> Run:
        id = run if isinstance(run, str) else self.ids[run]
        return Run(self._native.read(id), id, self.scenario, self.seed)

    def _ipython_key_completions_(self) -> List[str]:
        return self.ids

    def table(self) -> pd.DataFrame:
        """Attributes of the runs, a row each: wheel, condition, label."""
        import pandas as pd

        return pd.DataFrame([run.attributes for run in self], index=pd.Index(self.ids, name="run"))

    def inspect(self) -> Inspection:
        """Checks units, signs, zeros, clocks and labels; findings do not raise."""
        return Inspection(document(["inspect", self.path], partial=True))

    def recognize(
        self,
        *,
        method: str = "improved",
        window: Optional[float] = None,
        window_passes: Optional[float] = None,
        reference: Union[RunFile, str, os.PathLike, None] = None,
        bandwidth: Optional[float] = None,
        runs: Optional[Iterable[str]] = None,
        progress: Progress = False,
    ) -> Recognition:
        """How the lugs meet the ground, window by window.

        Args:
            method: `improved` (lug by lug) or `paper` (regions of the features).
            window: length of the windows [s]; 15 s unless given.
            window_passes: length of the windows in lug passes, in place of `window`.
            reference: runs on flat hard ground measured on the same rig; computed unless given.
            bandwidth: corner of the low-pass [Hz]; 100 Hz unless given.
            runs: only these runs.

        Raises:
            InvalidInput: no run can be recognised; the message says what the first one lacks.
        """
        reference = reference.path if isinstance(reference, RunFile) else reference
        words: List[Word] = ["recognize", self.path, "--method", method]
        words += option("--window", window) + option("--window-passes", window_passes)
        words += option("--reference", reference) + option("--bandwidth", bandwidth)
        return Recognition(document(words + repeated("--run", runs), progress=progress))

    def identify(
        self,
        *,
        terrain_class: str = "auto",
        law: Optional[str] = None,
        stress: Optional[str] = None,
        known: Optional[Mapping[str, float]] = None,
        slip: Optional[tuple] = None,
        bulk_density: Optional[float] = None,
        lug_thickness: Optional[float] = None,
        exit_angle: Optional[float] = None,
        cylinder: Optional[str] = None,
        runs: Optional[Iterable[str]] = None,
        progress: Progress = False,
    ) -> Identification:
        """Terrain parameters from steady loads, slip and sinkage, with confidence intervals.

        Args:
            terrain_class: ALCT, SLCT, LEIS, or `auto` to recognise it run by run.
            law: `own` (stresses over rim and lugs) or `paper` (equations (62)-(66)).
            stress: distribution of stress that `own` presumes.
            known: parameters measured otherwise, as `{"n0": 1.1}`; names and units as in the result.
            slip: lowest and highest slip ratio [-] of the rows that count.
            bulk_density: of the soil [kg/m^3].
            lug_thickness: along the circumference [m].
            exit_angle: coefficient c3 [-], from -1 to 0.
            cylinder: `rim` or `lug-tips`, for `paper`.
            runs: only these runs.

        Raises:
            InvalidInput: no run gives parameters; the message says why, run by run.
        """
        words: List[Word] = ["identify", self.path, "--class", terrain_class]
        words += option("--law", law) + option("--stress", stress)
        words += repeated("--known", [f"{name}={float(value)!r}" for name, value in (known or {}).items()])
        words += option("--slip", f"{slip[0]}:{slip[1]}" if slip else None)
        words += option("--bulk-density", bulk_density) + option("--lug-thickness", lug_thickness)
        words += option("--exit-angle", exit_angle) + option("--cylinder", cylinder)
        return Identification(document(words + repeated("--run", runs), progress=progress))

    def diagnose(self, scenario: Scenario, **options: Any) -> Diagnosis:
        """Why these runs and a scenario disagree: `lugwheel.diagnose(self, scenario, **options)`."""
        from .diagnosis import diagnose

        return diagnose(self, scenario, **options)

    def __repr__(self) -> str:
        origin = "simulated" if self.scenario else "measured"
        return f"<lugwheel run file {self.path}: {len(self)} {origin} runs>"


def read(path: Union[str, os.PathLike]) -> RunFile:
    """Opens a run file.

    Raises:
        InvalidInput: it is not there, damaged, or no run file.
    """
    return RunFile(path)


def import_campaign(
    campaign: Union[str, os.PathLike], out: Union[str, os.PathLike], *, force: bool = False
) -> RunFile:
    """Imports measured CSV files as a campaign file (TOML) describes them.

    Args:
        campaign: the campaign file.
        out: run file to write.
        force: replace an existing run file.
    """
    document(["import", campaign, "--out", out, *flag("--force", force)])
    return RunFile(out)
