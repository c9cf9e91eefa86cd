"""What is in a run file, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List

if TYPE_CHECKING:
    import pandas as pd


class Inspection:
    """Runs, channels and findings of a run file."""

    def __init__(self, document: Dict[str, Any]) -> None:
        self.document = document

    @property
    def findings(self) -> List[Dict[str, Any]]:
        """What is odd: severity, run, channel, what was found, what to do."""
        return self.document["findings"]

    @property
    def is_sound(self) -> bool:
        """Whether no finding is an error."""
        return not any(finding["severity"] == "error" for finding in self.findings)

    @property
    def table(self) -> pd.DataFrame:
        """The findings, a row each."""
        import pandas as pd

        return pd.DataFrame(self.findings)

    @property
    def channels(self) -> pd.DataFrame:
        """Channels of all runs, a row each: unit, rate, duration, extremes, steady mean."""
        import pandas as pd

        rows = [
            {"run": run["run"], **channel} for run in self.document["runs"] for channel in run["channels"]
        ]
        return pd.DataFrame(rows)

    def _repr_html_(self) -> str:
        return self.table.to_html()

    def __repr__(self) -> str:
        counts = [
            f"{sum(finding['severity'] == severity for finding in self.findings)} {severity}s"
            for severity in ("error", "warning")
        ]
        return f"<lugwheel inspection of {len(self.document['runs'])} runs: {', '.join(counts)}>"
