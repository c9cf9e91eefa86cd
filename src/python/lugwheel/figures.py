"""Results as matplotlib figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, List, Optional, Sequence

if TYPE_CHECKING:
    import matplotlib.axes

    from .diagnosis import Diagnosis
    from .identification import Identification
    from .recognition import Recognition
    from .run import Channel, Run

_NAMES = {
    "acceleration_y": "acceleration",
    "normal_force": "normal force $F_N$",
    "drawbar_pull": "drawbar pull $F_{DP}$",
    "driving_torque": "torque $T$",
    "sinkage": "sinkage $z$",
    "slip_ratio": "slip ratio $s$",
    "wheel_angle": "wheel angle",
    "forward_speed": "forward speed",
    "load": "load $W$",
}
_UNITS = {"drawbar_pull": "N", "load": "N", "driving_torque": "N m"}


def _axes(ax: Optional[matplotlib.axes.Axes]) -> matplotlib.axes.Axes:
    if ax is not None:
        return ax
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]


def _label(name: str, unit: str) -> str:
    shown = _NAMES.get(name, name.replace("_", " "))
    return f"{shown} [-]" if unit == "1" else f"{shown} [{unit}]"


def run(run: Run, channels: Optional[Sequence[str]], ax: Optional[matplotlib.axes.Axes]) -> Any:
    """Channels of a run over time."""
    names = list(run.channels if channels is None else channels)
    if ax is not None or len(names) == 1:
        axes: List[matplotlib.axes.Axes] = [_axes(ax)] * len(names)
    else:
        import matplotlib.pyplot as plt

        size = (8.0, 1.0 + 1.3 * len(names))
        axes = list(plt.subplots(len(names), sharex=True, figsize=size, layout="constrained")[1])
    for name, own in zip(names, axes):
        _trace(run.channel(name), own)
    axes[-1].set_xlabel("time [s]")
    return axes[0] if len(set(map(id, axes))) == 1 else axes


def _trace(channel: Channel, ax: matplotlib.axes.Axes) -> None:
    ax.plot(channel.time, channel.samples, linewidth=0.6, label=channel.name)
    ax.set_ylabel(_label(channel.name, channel.unit))


def classes(recognition: Recognition, ax: Optional[matplotlib.axes.Axes]) -> matplotlib.axes.Axes:
    """Classes of the windows of every run over time."""
    from .data_set import CLASSES

    ax = _axes(ax)
    windows = recognition.document["windows"]
    runs = list(dict.fromkeys(window["run"] for window in windows))
    for number, name in enumerate(CLASSES):
        own = [window for window in windows if window["class"] == name]
        if own:
            ax.barh(
                [runs.index(window["run"]) for window in own],
                [window["end_s"] - window["start_s"] for window in own],
                left=[window["start_s"] for window in own],
                color=f"C{number}",
                edgecolor="white",
                label=name,
            )
    ax.set_yticks(range(len(runs)), runs)
    ax.invert_yaxis()
    ax.set_xlabel("time [s]")
    ax.legend()
    return ax


def forces(
    identification: Identification, quantity: str, fit: int, ax: Optional[matplotlib.axes.Axes]
) -> matplotlib.axes.Axes:
    """Measured and fitted forces of a fit over slip."""
    ax = _axes(ax)
    rows = identification.rows(fit).sort_values("slip")
    ax.plot(rows["slip"], rows[f"measured_{quantity}"], "o", label="measured")
    ax.plot(rows["slip"], rows[f"fitted_{quantity}"], "-", label="fitted")
    ax.set_xlabel("slip ratio $s$ [-]")
    ax.set_ylabel(_label(quantity, _UNITS[quantity]))
    ax.legend()
    return ax


def probabilities(
    diagnosis: Diagnosis, causes: int, ax: Optional[matplotlib.axes.Axes]
) -> matplotlib.axes.Axes:
    """The most probable causes."""
    ax = _axes(ax)
    first = list(diagnosis.probabilities.items())[:causes]
    ax.barh([name for name, _ in first], [probability for _, probability in first])
    ax.invert_yaxis()
    ax.set_xlim(0.0, 1.0)
    ax.set_xlabel("probability [-]")
    return ax
