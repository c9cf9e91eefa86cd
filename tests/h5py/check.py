"""What h5py makes of a run file, and a run file as somebody else would write it.

check.py read FILE        checks the file that the test wrote
check.py write FILE       writes a measured campaign in other types than this program's
check.py spoil FOLDER WHAT...  writes campaigns with one thing missing or wrong each, to WHAT.h5
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
    equal(f"attributes of {where}", sorted(attributes), sorted(expected))
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
    equal("channels", sorted(run["channels"]), ["normal_force", "wheel_angle"])
    force = run["channels/normal_force"]
    check_attributes("normal_force", force.attrs, {
        "unit": "N",
        "sample_rate_hz": 500.0,
        "start_s": 0.25,
        "steadiness": "steady",
    })
    equal("precision of forces", force.dtype, np.float32)
    equal("normal_force", force[:], (100.0 + np.arange(40000) % 7).astype(np.float32))
    angle = run["channels/wheel_angle"]
    check_attributes("wheel_angle", angle.attrs, {"unit": "rad", "sample_rate_hz": 10.0, "start_s": 0.0})
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


if __name__ == "__main__":
    {"read": read, "write": write, "spoil": spoil}[sys.argv[1]](*sys.argv[2:])
