"""What h5py makes of a run file, and a run file as somebody else would write it.

check.py read FILE        checks the file that the test wrote
check.py write FILE       writes a measured campaign in other types than this program's
check.py spoil FOLDER WHAT...  writes campaigns with one thing missing or wrong each, to WHAT.h5
check.py rewrite FILE FOLDER KIND...  copies a run file as other programs would have written it, to KIND.h5
"""

import sys

try:
    import h5py
    import numpy as np
except ImportError as missing:
    sys.exit(f"h5py is missing ({missing}): run `pip install h5py`")


def equal(what, found, expected):
    if not np.array_equal(found, expected):
        sys.exit(f"{what}: expected {expected!r}, found {found!r}")


def check_attributes(where, attributes, expected):
    """What HDF5 itself has to say of dimensions aside."""
    equal(f"attributes of {where}", sorted(set(attributes) - {"DIMENSION_LIST"}), sorted(expected))
    for name, value in expected.items():
        equal(f"{where} {name}", attributes[name], value)
        if isinstance(value, str):
            equal(f"type of {where} {name}", type(attributes[name]), str)


def read(path):
    with h5py.File(path, "r") as file:
        check_attributes("/", file.attrs, {
            "format": "lugwheel-runs",
            "format_version": 1,
            "created_by": file.attrs["created_by"],
            "scenario": "version = 1  # 5 µm\n",
            "seed": 2**64 - 1,
        })
        equal("program", file.attrs["created_by"].split()[0], "lugwheel")
        equal("runs", list(file["runs"]), ["measured", "simulated"])
        check_simulated(file["runs/simulated"])
        check_measured(file["runs/measured"])


def check_simulated(run):
    check_attributes(run.name, run.attrs, {
        "wheel_mass_kg": 4.0,
        "wheel_radius_m": 0.14,
        "wheel_width_m": 0.15,
        "lug_count": 28,
        "lug_height_m": 0.015,
        "load_n": 100.0,
        "speed_m_s": 0.014,
        "slip_ratio": 0.1,
        "terrain": "SGT",
        "class": "LEIS",
        "repeat": 3,
        "day": "2023-05-01",
        "notes": "",
        "physics_rate_hz": 128000.0,
    })
    equal("groups", sorted(run), ["channels", "truth"])
    names = ["normal_force", "time", "time_wheel_angle", "wheel_angle"]
    equal("channels and times", sorted(run["channels"]), names)
    force = run["channels/normal_force"]
    check_attributes("normal_force", force.attrs, {
        "unit": "N",
        "units": "N",
        "sample_rate_hz": 500.0,
        "start_s": 0.25,
        "steadiness": "steady",
    })
    equal("precision of forces", force.dtype, np.float32)
    equal("normal_force", force[:], (100.0 + np.arange(40000) % 7).astype(np.float32))
    angle = run["channels/wheel_angle"]
    check_attributes("wheel_angle", angle.attrs, {
        "unit": "rad",
        "units": "rad",
        "sample_rate_hz": 10.0,
        "start_s": 0.0,
    })
    check_time(force, "time", 0.25 + np.arange(40000) / 500.0)
    check_time(angle, "time_wheel_angle", np.arange(5) / 10.0)
    equal("precision of angles", angle.dtype, np.float64)
    equal("wheel_angle", angle[:], np.arange(5) / 3.0)

    truth = run["truth"]
    equal("truth", sorted(truth), ["class_windows", "contacts", "parameters", "profile"])
    equal("share at the force limit", truth.attrs["carriage_at_limit"], 0.25)
    contacts = truth["contacts"]
    equal("columns of contacts", contacts.dtype.names, ("lug", "start_s", "end_s", "entered"))
    equal("contacts", contacts[0].item(), (3, 0.5, 1.25, 1))
    equal("contacts", contacts[1].item(), (4, 1.0, 2.5, 0))
    windows = truth["class_windows"]
    equal("columns of windows", windows.dtype.names, ("start_s", "end_s", "class", "terrain"))
    equal("windows", windows[0].item(), (0.0, 15.0, b"LEIS", b"SGT"))
    equal("columns of the profile", truth["profile"].dtype.names, ("x", "height"))
    equal("profile", truth["profile"]["height"], [0.0, 0.002])
    check_attributes("parameters", truth["parameters"].attrs, {"cohesion": 300.0})


def check_time(channel, name, expected):
    """The dimension scale of a channel has the time of each sample, in a hundredth of the channel's size."""
    (time,) = channel.dims[0].values()
    equal(f"scale of {channel.name}", time.name, f"{channel.parent.name}/{name}")
    equal(f"{time.name} is a scale", time.is_scale, True)
    equal(f"units of {time.name}", time.attrs["units"], "s")
    seconds = time[:] * time.attrs["scale_factor"] + time.attrs["add_offset"]
    equal(f"{time.name} within 1 ns", np.abs(seconds - expected).max() < 1e-9, True)
    if len(time) > 1000:
        share = time.id.get_storage_size() / (channel.size * channel.dtype.itemsize)
        equal(f"{time.name} is small", share < 0.03, True)


def check_measured(run):
    equal("groups", sorted(run), ["channels", "means"])
    equal("channels", list(run["channels"]), [])
    pull = run["means/drawbar_pull"]
    equal("drawbar_pull", pull[()], -6.5)
    check_attributes("drawbar_pull", pull.attrs, {"unit": "N", "sd": 0.7, "n": 1200})
    equal("label", run.attrs["terrain"], "")


def write(path):
    with h5py.File(path, "w") as file:
        campaign(file)


def campaign(file):
    """Fixed-length ASCII texts, big-endian and integer numbers, arrays of one, matrix columns."""
    file.attrs["format"] = np.bytes_("lugwheel-runs")
    file.attrs["format_version"] = np.array([1], dtype=">i2")
    run = file.create_group("runs/first")
    run.attrs["wheel_radius_m"] = np.array([[0.14]], dtype=">f4")
    run.attrs["wheel_width_m"] = 0.15
    run.attrs["lug_count"] = 28.0
    run.attrs["lug_height_m"] = 0.015
    run.attrs["load_n"] = np.int64(100)
    run.attrs["speed_m_s"] = 0.014
    run.attrs["slip_ratio"] = 0.1
    run.attrs["terrain"] = np.bytes_("ST")
    run.attrs["notes"] = h5py.Empty("S1")
    force = run.create_dataset("channels/normal_force", data=np.array([[99], [101]], dtype=">i4"))
    force.attrs["unit"] = np.array([b"N"])
    force.attrs["sample_rate_hz"] = 100
    force.attrs["start_s"] = 0
    return run, force


def spoil(folder, *whats):
    for what in whats:
        spoil_one(f"{folder}/{what}.h5", what)


def spoil_one(path, what):
    with h5py.File(path, "w") as file:
        run, force = campaign(file)
        if what == "format":
            del file.attrs["format"]
        elif what == "other_format":
            file.attrs["format"] = "weather"
        elif what == "version":
            file.attrs["format_version"] = 2
        elif what == "runs":
            del file["runs"]
        elif what == "load":
            del run.attrs["load_n"]
        elif what == "load_text":
            run.attrs["load_n"] = "heavy"
        elif what == "lug_count":
            run.attrs["lug_count"] = -1
        elif what == "terrain":
            run.attrs["terrain"] = "SAND"
        elif what == "unit":
            del force.attrs["unit"]
        elif what == "matrix":
            run["channels/sinkage"] = np.zeros((3, 4))
        elif what == "text_channel":
            run["channels/sinkage"] = ["a", "b"]
        elif what == "contacts":
            run["truth/contacts"] = np.zeros(2, dtype=[("lug", "i4"), ("start_s", "f8")])
        else:
            sys.exit(f"no such thing to spoil: {what}")


def rewrite(source, folder, *kinds):
    for kind in kinds:
        with h5py.File(source, "r") as old:
            rewrite_one(old, f"{folder}/{kind}.h5", kind)


FILE_OPTIONS = {
    "matlab": {"userblock_size": 512},
    "latest": {"libver": "latest"},
    "interrupted": {"libver": "latest"},
}

SAMPLES = {
    "matlab": lambda samples: samples.astype("f8").reshape(1, -1),
    "matlab_columns": lambda samples: samples.astype("f8").reshape(-1, 1),
    "big_endian": lambda samples: samples.astype(">f8"),
    "integers": lambda samples: np.round(samples).astype("i2"),
    "half": lambda samples: samples.astype("f2"),
    "extended": lambda samples: samples.astype(np.longdouble),
    "complex": lambda samples: samples.astype("c16"),
    "booleans": lambda samples: samples > 0,
    "texts": lambda samples: np.array([str(sample) for sample in samples], dtype=object),
}

STORAGE = {
    "szip": {"compression": "szip"},
    "checked": {"compression": "gzip", "shuffle": True, "fletcher32": True},
    "scaled": {"scaleoffset": 12},
    "growing": {"maxshape": (None,), "chunks": (16,)},
    "lzf": {"compression": "lzf"},
    "lzf_shuffled": {"compression": "lzf", "shuffle": True},
}


def rewrite_one(old, path, kind):
    with h5py.File(path, "w", **FILE_OPTIONS.get(kind, {})) as new:
        attributes(old, new, kind)
        for name, run in old["runs"].items():
            copy = new.create_group(f"runs/{name}")
            attributes(run, copy, kind)
            for channel, samples in run["channels"].items():
                if samples.is_scale:
                    continue
                change = SAMPLES.get(kind, lambda samples: samples)
                is_long = samples.size > 32
                storage = STORAGE.get(kind, {}) if is_long else {}
                dataset = copy.create_dataset(f"channels/{channel}", data=change(samples[:]), **storage)
                attributes(samples, dataset, kind)
            for mean, value in run["means"].items():
                number = value[()]
                if kind == "half_means":
                    number = np.float16(number)
                if kind.startswith("matlab"):
                    number = np.array([[number]])
                attributes(value, copy.create_dataset(f"means/{mean}", data=number), kind)
            if kind == "lzf_truth":
                contacts = run["truth/contacts"]
                copy.create_dataset("truth/contacts", data=contacts[:], chunks=True, compression="lzf")
    if kind == "matlab":
        with open(path, "r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))
    if kind == "interrupted":
        interrupt(path)


def interrupt(path):
    """Leaves the file as a logger that writes for readers (SWMR) and is killed."""
    import os

    child = os.fork()
    if child == 0:
        file = h5py.File(path, "r+", libver="latest")
        file.swmr_mode = True
        os._exit(0)
    os.waitpid(child, 0)


def attributes(old, new, kind):
    for name, value in old.attrs.items():
        if name == "DIMENSION_LIST":
            continue
        if isinstance(value, str) and kind == "matlab":
            new.attrs.create(name, np.array([value], dtype=object), dtype=h5py.string_dtype())
        elif isinstance(value, str) and kind == "matlab_columns":
            new.attrs[name] = np.bytes_(value) if value else h5py.Empty("S1")
        elif isinstance(value, str):
            new.attrs[name] = value
        elif kind.startswith("matlab"):
            new.attrs[name] = np.array([float(value)])
        elif kind == "half_attributes" and isinstance(value, np.floating):
            new.attrs[name] = np.float16(value)
        else:
            new.attrs[name] = value


if __name__ == "__main__":
    {"read": read, "write": write, "spoil": spoil, "rewrite": rewrite}[sys.argv[1]](*sys.argv[2:])
