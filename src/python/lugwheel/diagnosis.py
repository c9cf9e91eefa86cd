"""Why a rig and its simulation disagree."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Optional, Union

from ._command import Word, document, flag, option, repeated
from ._progress import Progress
from .page import Page
from .run_file import RunFile

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas as pd

    from .scenarios import Scenario


class Diagnosis:
    """The probable cause of a difference, with how far the answer can be trusted."""

    def __init__(self, document: Dict[str, Any], page: Page, scenarios: Dict[str, str]) -> None:
        self.document = document
        self.page = page
        self._scenarios = scenarios

    @property
    def answer(self) -> str:
        """The answer in words."""
        return self.document["answer"]

    @property
    def verdict(self) -> str:
        """`none`, `parameter`, `effect`, `effects`, `unknown` or `undecided`."""
        return self.document["verdict"]

    @property
    def probabilities(self) -> Dict[str, float]:
        """Probability of each cause, largest first."""
        pairs = self.document["probabilities"].items()
        return dict(sorted(pairs, key=lambda pair: -pair[1]))

    @property
    def effects(self) -> pd.DataFrame:
        """Effects, most probable first: magnitude, unit, 95 % interval, indistinguishable ones."""
        import pandas as pd

        return pd.DataFrame(self.document["effects"])

    @property
    def set(self) -> List[str]:
        """Causes that together hold the true one in 90 % of campaigns like this."""
        return self.document["set"]

    @property
    def limits(self) -> Dict[str, float]:
        """Magnitude of each effect whose change equals three standard deviations [unit of the effect]."""
        return self.document["limits"]

    @property
    def self_test(self) -> Dict[str, Any]:
        """How often the diagnosis is right on simulated rigs of this layout that it has not seen."""
        return self.document["self_test"]

    @property
    def gap(self) -> Dict[str, float]:
        """Distance of rig and simulation: nominal, recalibrated, with the effect, and the noise floor."""
        return self.document["gap"]

    @property
    def map(self) -> pd.DataFrame:
        """Differences by channel, domain and condition, with their deviations and false discovery rates."""
        import pandas as pd

        return pd.DataFrame(self.document["map"])

    @property
    def recalibrated(self) -> Optional[str]:
        """Text of the recalibrated scenario."""
        return self._scenarios.get("recalibrated")

    @property
    def with_effect(self) -> Optional[str]:
        """Text of the scenario with the named effects."""
        return self._scenarios.get("with_effect")

    def plot(self, ax: Optional[matplotlib.axes.Axes] = None, causes: int = 8) -> matplotlib.axes.Axes:
        """The most probable causes."""
        from . import figures

        return figures.probabilities(self, causes, ax)

    def to_html(self, path: Union[str, os.PathLike]) -> Path:
        """Writes the page of the diagnosis to a file, which must not be there yet."""
        return self.page.save(path)

    def _repr_html_(self) -> str:
        return self.page._repr_html_()

    def __repr__(self) -> str:
        return f"<lugwheel diagnosis: {self.answer}>"


def diagnose(
    measured: Union[RunFile, str, os.PathLike],
    scenario: Scenario,
    *,
    time: Optional[float] = None,
    without: Optional[Iterable[str]] = None,
    discrepancy: Optional[float] = None,
    runs: Optional[Iterable[str]] = None,
    seed: int = 1,
    jobs: Optional[int] = None,
    out: Optional[Union[str, os.PathLike]] = None,
    bank: Union[str, os.PathLike] = "output/bank",
    force: bool = False,
    progress: Progress = True,
) -> Diagnosis:
    """Where measured runs and a scenario differ, and which unmodelled effect causes it.

    The first diagnosis of a layout (conditions, channels, rates) simulates random rigs for minutes and keeps
    them in `bank`; Ctrl-C keeps those that are whole, and the next ones of that layout take seconds.

    Args:
        measured: the runs, repeats and several conditions if possible.
        scenario: the simulation of the rig; load, speed and slip come from the runs.
        time: time that the random rigs may take on this machine [s].
        without: effects that are impossible.
        discrepancy: how far any rig differs from any simulator, in margins of equivalence; 1 unless given,
            0 for simulated runs.
        runs: only these runs.
        seed: of the simulations.
        jobs: threads; all cores unless given.
        out: folder of page, numbers and scenarios, if they are to be kept.
        bank: folder of simulated rigs.
        force: replace results in `out`.
    """
    path = measured.path if isinstance(measured, RunFile) else measured
    with tempfile.TemporaryDirectory(prefix="lugwheel-") as folder:
        file = scenario.save(Path(folder) / f"{scenario.name}.toml")
        results = Path(folder) / "results" if out is None else Path(out)
        words: List[Word] = ["diagnose", "--measured", path, "--scenario", file, "--out", results, "--bank", bank]
        words += option("--time", time and f"{max(1, round(time))}s") + repeated("--without", without)
        words += option("--discrepancy", discrepancy) + option("--jobs", jobs) + repeated("--run", runs)
        words += ["--seed", seed, *flag("--force", force)]
        found = document(words, progress=progress)
        page = Page((results / "diagnosis.html").read_text(encoding="utf-8"))
        scenarios = {
            name: (results / f"{name}.toml").read_text(encoding="utf-8")
            for name in ("recalibrated", "with_effect")
            if (results / f"{name}.toml").exists()
        }
        return Diagnosis(found, page, scenarios)
