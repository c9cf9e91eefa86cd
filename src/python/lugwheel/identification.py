"""Terrain parameters with their intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas as pd

FORCES = ("drawbar_pull", "load", "driving_torque")
"""Forces of a steady row [N, N, N m]."""


class Identification:
    """One fit for each class and wheel."""

    def __init__(self, document: Any) -> None:
        self.fits: List[Dict[str, Any]] = document if isinstance(document, list) else [document]

    @property
    def table(self) -> pd.DataFrame:
        """Parameters by fit: value, bounds of the 95 % interval (None where unbounded), unit, identifiable."""
        import pandas as pd

        rows = []
        for number, fit in enumerate(self.fits):
            for name, parameter in fit["parameters"].items():
                low, high = parameter["ci95"] or (None, None)
                rows.append(
                    {
                        "fit": number,
                        "class": fit.get("class"),
                        "parameter": name,
                        "value": parameter["value"],
                        "low": low,
                        "high": high,
                        "unit": parameter["unit"],
                        "identifiable": parameter["identifiable"],
                        "reason": parameter.get("reason"),
                    }
                )
        return pd.DataFrame(rows).set_index(["fit", "parameter"])

    @property
    def warnings(self) -> List[str]:
        """Why the parameters may be wrong."""
        return [warning["message"] for fit in self.fits for warning in fit.get("warnings", [])]

    def rows(self, fit: int = 0) -> pd.DataFrame:
        """Steady rows of a fit: slip, sinkage [m], measured and fitted forces [N, N m]."""
        import pandas as pd

        rows = []
        for row in self.fits[fit].get("rows", []):
            flat = {"run": row["run"], "slip": row["slip"], "sinkage": row["sinkage"]}
            flat.update({f"measured_{force}": row[force] for force in FORCES})
            flat.update({f"fitted_{force}": row["fitted"][force] for force in FORCES})
            rows.append(flat)
        return pd.DataFrame(rows)

    def plot(
        self, quantity: str = "drawbar_pull", fit: int = 0, ax: Optional[matplotlib.axes.Axes] = None
    ) -> matplotlib.axes.Axes:
        """Measured and fitted `drawbar_pull`, `load` or `driving_torque` over slip."""
        from . import figures

        return figures.forces(self, quantity, fit, ax)

    def _repr_html_(self) -> str:
        return self.table.to_html()

    def __repr__(self) -> str:
        classes = ", ".join(str(fit.get("class", "plates")) for fit in self.fits)
        return f"<lugwheel identification: {classes}; {len(self.warnings)} warnings>"
