#!/usr/bin/env python3
"""Prints the levels of a data set's runs as `summarise.py` prints those of the beds.

    lugwheel dataset scenarios/single_wheel_gt.toml --runs 20 --out gravel.h5
    python3 tests/data/gravel_beds/levels.py gravel.h5
"""
import sys

import h5py
import numpy as np

RATE = 2000.0  # Hz, of the scenario's output
LAST = 14.0    # s
BANDS = ((2, 20), (20, 200), (200, 800))  # Hz


def rms(samples, low, high):
    spectrum = np.fft.rfft(samples - samples.mean())
    frequency = np.fft.rfftfreq(len(samples), 1.0 / RATE)
    spectrum[(frequency < low) | (frequency >= high)] = 0.0
    return np.fft.irfft(spectrum, len(samples)).std()


levels, pulls = [], []
with h5py.File(sys.argv[1]) as file:
    for run in file["runs"].values():
        last = slice(-int(LAST * RATE), None)
        acceleration = run["channels/acceleration_y"][last]
        levels.append([rms(acceleration, *band) for band in BANDS])
        pulls.append(run["channels/drawbar_pull"][last].mean())
levels, pulls = np.array(levels), np.array(pulls)
for (low, high), level in zip(BANDS, levels.T):
    mean, (least, most) = np.exp(np.log(level).mean()), np.quantile(level, (0.1, 0.9))
    print(f"{low}-{high} Hz: {mean:.3f} [{least:.3f}, {most:.3f}] m/s²")
print(f"pull: {pulls.mean():.1f} ± {pulls.std(ddof=1):.1f} N over {len(pulls)} runs")
