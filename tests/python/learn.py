"""How a learner loads a data set: h5py for the runs, csv or pandas for windows and splits.

learn.py FOLDER    checks the data set of FOLDER/dataset.h5 and FOLDER/runs.h5
"""

import csv
import json
import sys

try:
    import h5py
    import numpy as np
except ImportError as missing:
    sys.exit(f"h5py is missing ({missing}): run `pip install h5py`")


class Windows:
    """The windows of one part of a split, as torch.utils.data.Dataset wants them."""

    def __init__(self, stem, split="by_ground", part="train", channel="acceleration_y"):
        self.file = h5py.File(f"{stem}.h5", "r")
        self.channel = channel
        with open(f"{stem}.windows.csv", newline="") as text:
            self.rows = [row for row in csv.DictReader(text) if row[split] == part]

    def __len__(self):
        return len(self.rows)

    def __getitem__(self, index):
        row = self.rows[index]
        channel = self.file[f"runs/{row['run']}/channels/{self.channel}"]
        rate, first = channel.attrs["sample_rate_hz"], channel.attrs["start_s"]
        begin, end = (round((float(row[time]) - first) * rate) for time in ("start_s", "end_s"))
        return channel[begin:end], row["class"]


def check(holds, what):
    if not holds:
        sys.exit(what)


def check_parts(stem):
    parts = {part: Windows(stem, "by_run", part) for part in ("train", "validation", "test")}
    runs = {part: {row["run"] for row in windows.rows} for part, windows in parts.items()}
    check(all(runs.values()), f"a part is empty: {runs}")
    check(not (runs["train"] & runs["test"] or runs["train"] & runs["validation"]), "runs leak")
    for windows in parts.values():
        for index in range(len(windows)):
            samples, label = windows[index]
            check(samples.dtype == np.float32 and np.isfinite(samples).all(), "samples")
            check(len(samples) == round(0.5 * 2000), f"a window of {len(samples)} samples")
            check(label in ("ALCT", "SLCT", "LEIS", "UWTIC"), label)


def check_runs(folder):
    """runs.h5 holds what runs.csv does, typed and with units."""
    with open(f"{folder}/runs.csv", newline="") as text:
        rows = list(csv.DictReader(text))
    with h5py.File(f"{folder}/runs.h5", "r") as file:
        check(file.attrs["format"] == "lugwheel-table", "format")
        names = list(file.attrs["columns"])
        check(names == list(rows[0]), f"columns {names}")
        for name in names:
            column = file["columns"][name]
            cells = [row[name] for row in rows]
            if h5py.check_string_dtype(column.dtype):
                check(list(column.asstr()[:]) == cells, f"texts of {name}")
            else:
                numbers = np.array([float(cell or "nan") for cell in cells])
                check(np.array_equal(column[:], numbers, equal_nan=True), f"numbers of {name}")
        check(file["columns/normal_force_mean_n"].attrs["unit"] == "N", "unit")
        check(file["columns/run"].dtype == np.int64, "whole numbers")
        check_frame(file, names, rows)


def check_frame(file, names, rows):
    try:
        import pandas
    except ImportError:
        print("pandas is not there: its frames are not checked", file=sys.stderr)
        return
    frame = pandas.DataFrame({name: file["columns"][name][:] for name in names})
    check(frame.shape == (len(rows), len(names)), f"a frame of {frame.shape}")
    windows = pandas.read_csv(f"{file.filename[:-7]}dataset.windows.csv")
    check({"p1", "class", "by_both"} <= set(windows.columns), "columns of windows")


def check_croissant(stem):
    with open(f"{stem}.croissant.json") as text:
        document = json.load(text)
    check(document["conformsTo"] == "http://mlcommons.org/croissant/1.0", "conformsTo")
    files = {file["@id"]: file for file in document["distribution"]}
    for record_set in document["recordSet"]:
        sources = [field["source"] for field in record_set["field"] if "source" in field]
        for source in sources:
            check(source["fileObject"]["@id"] in files, f"{source} is of no file")
            with open(f"{stem[: -len('dataset')]}{source['fileObject']['@id']}", newline="") as text:
                check(source["extract"]["column"] in next(csv.reader(text)), f"no column {source}")
    try:
        import mlcroissant
    except ImportError:
        print("mlcroissant is not there: it does not judge the metadata", file=sys.stderr)
        return
    dataset = mlcroissant.Dataset(f"{stem}.croissant.json")
    check(not dataset.metadata.ctx.issues.errors, dataset.metadata.ctx.issues.report())
    windows = list(dataset.records("windows"))
    check(len(windows) == 40 and windows[0]["windows/terrain"] == b"HT", f"{windows[:1]}")
    check(len(list(dataset.records("runs"))) == 20, "records of runs")


if __name__ == "__main__":
    folder = sys.argv[1]
    check_parts(f"{folder}/dataset")
    check_runs(folder)
    check_croissant(f"{folder}/dataset")
