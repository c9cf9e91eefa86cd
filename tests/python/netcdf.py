"""What xarray makes of a run file and of a table, by both of its readers of netCDF.

netcdf.py FILE FOLDER    checks run `simulated` of FILE, and FOLDER/runs.h5 against FOLDER/runs.csv
"""

import csv
import sys

import h5netcdf  # noqa: F401
import netCDF4  # noqa: F401
import numpy as np
import xarray


def check(holds, what):
    if not holds:
        sys.exit(what)


def check_run(path, engine):
    with xarray.open_dataset(path, group="runs/simulated/channels", engine=engine) as run:
        check(set(run.sizes) == {"time", "time_wheel_angle"}, f"{engine}: dimensions {dict(run.sizes)}")
        check(set(run.data_vars) == {"normal_force", "wheel_angle"}, f"{engine}: {list(run.data_vars)}")
        check(np.allclose(run.time, 0.25 + np.arange(40000) / 500.0, atol=1e-9), f"{engine}: times")
        check(run.time.attrs["units"] == "s" and run.normal_force.attrs["units"] == "N", f"{engine}: units")
        second = run.normal_force.sel(time=slice(1.0, 1.999))
        check(second.size == 500, f"{engine}: {second.size} samples in a second at 500 Hz")


def check_table(folder, engine):
    with open(f"{folder}/runs.csv", newline="") as text:
        rows = list(csv.DictReader(text))
    with xarray.open_dataset(f"{folder}/runs.h5", group="columns", engine=engine) as table:
        frame = table.to_dataframe().reset_index()
    check(set(frame.columns) == set(rows[0]), f"{engine}: columns {list(frame.columns)}")
    check(list(frame["run"]) == [int(row["run"]) for row in rows], f"{engine}: runs")
    scenario = rows[0]["scenario"]
    found = frame[frame["scenario"] == scenario]
    expected = sum(row["scenario"] == scenario for row in rows)
    check(len(found) == expected > 0, f"{engine}: {len(found)} rows of {scenario!r}, not {expected}")


if __name__ == "__main__":
    for engine in ("h5netcdf", "netcdf4"):
        check_run(sys.argv[1], engine)
        check_table(sys.argv[2], engine)
