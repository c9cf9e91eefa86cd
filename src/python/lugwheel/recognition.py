"""Classes of wheel-terrain interaction, window by window."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Optional

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas as pd


class Recognition:
    """The class of every window, with its confidence and reason."""

    def __init__(self, document: Dict[str, Any]) -> None:
        self.document = document

    @property
    def table(self) -> pd.DataFrame:
        """A row for each window: run, start and end [s], class, confidence, reason, features, truth."""
        import pandas as pd

        table = pd.DataFrame(self.document["windows"])
        features = [window or [None] * 4 for window in table.pop("p")]
        for number in range(4):
            table[f"p{number + 1}"] = [window[number] for window in features]
        return table

    @property
    def accuracy(self) -> Optional[float]:
        """Share of the labelled windows that were recognised; None without labels."""
        return self.document.get("accuracy")

    @property
    def confusion(self) -> Optional[pd.DataFrame]:
        """Windows by true class (rows) and recognised class (columns); None without labels."""
        import pandas as pd

        counts = self.document.get("confusion")
        return None if counts is None else pd.DataFrame(counts).T

    def plot(self, ax: Optional[matplotlib.axes.Axes] = None) -> matplotlib.axes.Axes:
        """Classes of the windows over time, one row per run."""
        from . import figures

        return figures.classes(self, ax)

    def _repr_html_(self) -> str:
        return self.table.to_html()

    def __repr__(self) -> str:
        right = "" if self.accuracy is None else f", accuracy {self.accuracy:.2f}"
        return f"<lugwheel recognition of {len(self.document['windows'])} windows{right}>"
