"""One run: channels as arrays, attributes, ground truth."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _native
from .errors import InvalidInput

if TYPE_CHECKING:
    import matplotlib.axes
    import pandas as pd
    import xarray as xr

    from .page import Page


@dataclass(frozen=True, eq=False)
class Channel:
    """One quantity over time, equally spaced."""

    name: str
    unit: str
    sample_rate: float
    """Samples per second [Hz]."""
    start: float
    """Time of the first sample [s]."""
    samples: np.ndarray
    """The samples [unit], read-only."""

    @property
    def time(self) -> np.ndarray:
        """Time of every sample [s]."""
        return self.start + np.arange(len(self.samples)) / self.sample_rate

    def __len__(self) -> int:
        return len(self.samples)


class Run:
    """One run, simulated or measured. `run["drawbar_pull"]` are the samples of a channel [SI units]."""

    def __init__(
        self, native: _native.Run, id: str, scenario: Optional[str] = None, seed: Optional[int] = None
    ) -> None:
        self._native = native
        self.id = id
        self._scenario = scenario
        self._seed = seed

    @property
    def channels(self) -> List[str]:
        """Names of the channels."""
        return self._native.channels

    def channel(self, name: str) -> Channel:
        """A channel with its unit and times.

        Raises:
            InvalidInput: the run has no such channel; the message lists those it has.
        """
        described, samples = self._native.description(name), self._native.samples(name)
        if described is None or samples is None:
            raise InvalidInput(f"{self.id} has no channel {name!r}; it has {', '.join(self.channels)}")
        return Channel(name, *described, samples)

    def __getitem__(self, name: str) -> np.ndarray:
        return self.channel(name).samples

    def __contains__(self, name: object) -> bool:
        return name in self.channels

    def _ipython_key_completions_(self) -> List[str]:
        return self.channels

    @property
    def attributes(self) -> Dict[str, Any]:
        """Wheel, condition and label, by the names of run files; None where unknown."""
        return self._native.attributes

    @property
    def means(self) -> Dict[str, Tuple[float, str, float, int]]:
        """Steady values without a time series: value, unit, standard deviation and number of samples."""
        return self._native.means

    @property
    def truth(self) -> Optional[Dict[str, Any]]:
        """What a simulation knows and no sensor measures: contacts of the lugs, classes, parameters, ground."""
        return self._native.truth

    @property
    def label(self) -> Optional[str]:
        """Class of the run: ALCT, SLCT, LEIS or UWTIC; None where unknown or mixed."""
        return self.attributes["class"]

    def steady(self, name: str) -> Optional[float]:
        """Mean over the middle half of a channel [SI unit], or the mean that was measured.

        `steadiness` says whether it depends on how long the wheel had been rolling.
        """
        return self._native.steady_mean(name)

    def steadiness(self, name: str) -> Optional[str]:
        """`steady`, `drifting` or `too_short` to decide."""
        return self._native.steadiness(name)

    def to_pandas(self, channels: Optional[Iterable[str]] = None) -> pd.DataFrame:
        """Channels as columns over the time [s] of the channel that is sampled fastest.

        Slower channels are interpolated linearly, NaN outside of their record, and listed in
        `.attrs["interpolated"]`, beside `"units"` and the attributes of the run. `to_xarray` keeps the times of
        each.
        """
        import pandas as pd

        chosen = self._chosen(channels)
        if not chosen:
            return pd.DataFrame(index=pd.Index([], name="time_s"))
        fastest = max(chosen, key=lambda channel: channel.sample_rate)
        own = next(group for group in _grids(chosen) if fastest in group)
        time = fastest.time
        columns = {
            channel.name: channel.samples if channel in own else _interpolated(channel, time)
            for channel in chosen
        }
        frame = pd.DataFrame(columns, index=pd.Index(time, name="time_s"))
        attributes: Dict[Any, Any] = {
            **self.attributes,
            "units": {channel.name: channel.unit for channel in chosen},
            "interpolated": [channel.name for channel in chosen if channel not in own],
        }
        frame.attrs = attributes
        return frame

    def to_xarray(self, channels: Optional[Iterable[str]] = None) -> xr.Dataset:
        """Channels over the coordinate `time` [s], with their units; one coordinate for each set of times."""
        import xarray as xr

        grids = _grids(self._chosen(channels))
        coordinates: Dict[str, Any] = {}
        variables: Dict[str, Any] = {}
        for group in grids:
            first = group[0]
            time = "time" if len(grids) == 1 else f"time_{first.sample_rate:g}_hz"
            time = time if time not in coordinates else f"{time}_{first.name}"
            coordinates[time] = (time, first.time, {"units": "s"})
            for channel in group:
                variables[channel.name] = (time, channel.samples, {"units": channel.unit})
        known = {name: value for name, value in self.attributes.items() if value is not None}
        return xr.Dataset(variables, coordinates, {"id": self.id, **known})

    def save(self, path: Union[str, os.PathLike]) -> Path:
        """Writes the run to a run file, which must not be there yet."""
        path = Path(path)
        if path.exists():
            raise InvalidInput(f"{path} exists; name another file")
        _native.write_runs(path, [(self.id, self._native)], self._scenario, self._seed)
        return path

    def plot(
        self, channels: Optional[Sequence[str]] = None, ax: Optional[matplotlib.axes.Axes] = None
    ) -> Any:
        """Channels over time: on `ax` where one channel is asked for, else on axes of their own.

        Returns:
            The axes, one a channel.
        """
        from . import figures

        return figures.run(self, channels, ax)

    def animate(self) -> Page:
        """The page of the run: the wheel on its ground over time, with its traces."""
        from .page import page_of_run

        with tempfile.TemporaryDirectory() as folder:
            return page_of_run(self.save(Path(folder) / "run.h5"), self.id)

    def _chosen(self, channels: Optional[Iterable[str]]) -> List[Channel]:
        return [self.channel(name) for name in (self.channels if channels is None else channels)]

    def __repr__(self) -> str:
        label = f", {self.label}" if self.label else ""
        terrain = f" on {self.attributes['terrain']}" if self.attributes["terrain"] else ""
        return f"<lugwheel run {self.id}{terrain}{label}: {', '.join(self.channels) or 'means'}>"


def _interpolated(channel: Channel, time: np.ndarray) -> np.ndarray:
    """Samples of a channel at other times [s], NaN outside of its record."""
    return np.interp(time, channel.time, channel.samples, left=np.nan, right=np.nan)


def _grids(channels: Iterable[Channel]) -> List[List[Channel]]:
    """Channels by the times at which they are sampled."""
    grids: Dict[Tuple[float, float, int], List[Channel]] = {}
    for channel in channels:
        grids.setdefault((channel.sample_rate, channel.start, len(channel)), []).append(channel)
    return list(grids.values())
