"""What the channels of a run file would take with other filters.

sizes.py FILE    prints kB a second of run, and the computing time of writing, filter by filter
"""

import os
import sys
import tempfile
import time

import h5py

CHUNK = 16384


def filters():
    yield "none", {}
    yield "gzip 1", {"compression": "gzip", "compression_opts": 1}
    for level in (1, 4, 6, 9):
        yield f"shuffle, gzip {level}", {"compression": "gzip", "compression_opts": level, "shuffle": True}


def write(runs, path, options):
    with h5py.File(path, "w", libver=("v108", "v108")) as out:
        for run, channels in runs.items():
            for name, samples in channels.items():
                chunks = (min(len(samples), CHUNK),) if options else None
                out.create_dataset(f"{run}/{name}", data=samples, chunks=chunks, **options)


def main(source):
    with h5py.File(source) as file:
        channels = {run: file[f"runs/{run}/channels"] for run in file["runs"]}
        runs = {run: {name: samples[:] for name, samples in of.items()} for run, of in channels.items()}
        seconds = sum(len(of["normal_force"]) / of["normal_force"].attrs["sample_rate_hz"] for of in channels.values())
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "filtered.h5")
        for label, options in filters():
            begun = time.process_time()
            write(runs, path, options)
            spent = time.process_time() - begun
            size = os.path.getsize(path)
            print(f"{label:<18}{size / seconds / 1e3:8.1f} kB/s {1e3 * spent / seconds:8.2f} ms/s")


if __name__ == "__main__":
    main(sys.argv[1])
