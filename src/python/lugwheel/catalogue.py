"""The catalogue of effects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict

from ._command import document

if TYPE_CHECKING:
    import pandas as pd


def effects() -> pd.DataFrame:
    """Departures from the ideal rig that a simulation can include, by full name (`gain_error.drawbar_pull`).

    Columns: what each is and edits, unit of the magnitude, its neutral value, range, levels that trials use
    (low, typical, high), signature, effects that look alike, source.
    """
    import pandas as pd

    rows = [_row(effect, seat) for effect in document(["effects"]) for seat in effect["seats"]]
    return pd.DataFrame(rows).set_index("name")


def _row(effect: Dict[str, Any], seat: Dict[str, Any]) -> Dict[str, Any]:
    """An effect on one of the channels it can act on."""
    channel = seat["channel"]
    return {
        "name": f"{effect['name']}.{channel}" if channel else effect["name"],
        "title": effect["title"],
        "edits": effect["edits"],
        **{key: seat[key] for key in ("unit", "neutral", "range", "levels")},
        "signature": effect["signature"]["dependence"],
        "confusers": effect["confusers"],
        "source": "; ".join(effect["source"].values()),
    }
