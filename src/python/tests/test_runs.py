import subprocess
import sys
import threading
import time
import _thread

import h5py
import numpy as np
import pytest

import lugwheel as lw


def test_samples_are_read_only_views_that_outlive_their_run(sand):
    samples = sand.edited(duration=0.2).run()["drawbar_pull"]
    before = samples.copy()
    with pytest.raises(ValueError):
        samples[0] = 0.0
    assert samples.base is not None and np.array_equal(samples, before)


def test_one_seed_gives_the_same_bits_here_and_by_the_program(sand, run, tmp_path):
    assert np.array_equal(run["acceleration_y"], sand.run(seed=1)["acceleration_y"])
    assert not np.array_equal(run["acceleration_y"], sand.run(seed=2)["acceleration_y"])
    file = sand.save(tmp_path / "sand.toml")
    out = tmp_path / "run.h5"
    program = [sys.executable, "-m", "lugwheel", "simulate", str(file), "--out", str(out), "--quiet"]
    subprocess.run(program, check=True, capture_output=True)
    written = lw.read(out)[0]
    assert written.channels and all(np.array_equal(written[name], run[name]) for name in written.channels)


def test_units_and_times_come_along_to_pandas_and_xarray(run):
    frame = run.to_pandas()
    assert frame.index.name == "time_s" and frame.attrs["units"]["drawbar_pull"] == "N"
    assert np.array_equal(frame["drawbar_pull"], run["drawbar_pull"])
    assert "sinkage" in frame.attrs["interpolated"] and "drawbar_pull" not in frame.attrs["interpolated"]
    last = run.channel("sinkage")
    index = len(last) // 2
    at = np.interp(last.time[index], frame.index, frame["sinkage"].to_numpy())
    assert abs(at - last.samples[index]) < 1e-6
    dataset = run.to_xarray()
    assert dataset["sinkage"].attrs["units"] == "m" and dataset.attrs["terrain"] == "ST"
    assert np.array_equal(dataset["sinkage"], run["sinkage"])


def test_truth_has_contacts_classes_and_ground(run):
    truth = run.truth
    assert run.label == "LEIS" and truth["class_windows"][0]["class"] == "LEIS"
    contacts = truth["contacts"]
    assert len(contacts["lug"]) == len(contacts["start_s"]) > 0
    assert np.all(contacts["end_s"] >= contacts["start_s"]) and contacts["entered"].dtype == bool
    assert len(truth["profile"]["x"]) == len(truth["profile"]["height"])


def test_h5py_and_this_package_use_hdf5_in_one_process(run, tmp_path):
    path = run.save(tmp_path / "run.h5")
    with h5py.File(path) as file:
        group = file["runs/run_000000/channels"]
        for name in run.channels:
            assert np.array_equal(group[name][:].astype(float), run[name])
        assert np.array_equal(lw.read(path)[0]["sinkage"], run["sinkage"])
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = np.arange(10.0)
        other = run.save(tmp_path / "second.h5")
    assert lw.read(other).ids == ["run_000000"]


def test_a_file_is_never_replaced_by_a_run(run, tmp_path):
    path = run.save(tmp_path / "run.h5")
    with pytest.raises(lw.InvalidInput, match="exists"):
        run.save(path)
    with pytest.raises(lw.InvalidInput, match="no_such.h5") as caught:
        lw.read(tmp_path / "no_such.h5")
    assert caught.value.file.endswith("no_such.h5")
    with pytest.raises(lw.InvalidInput, match="it has acceleration_y"):
        run["pull"]


def test_the_interpreter_goes_on_while_a_run_is_simulated(sand):
    ticks = 0
    worker = threading.Thread(target=sand.edited(duration=40.0).run)
    worker.start()
    while worker.is_alive():
        ticks += 1
        time.sleep(0.001)
    assert ticks > 20


def test_ctrl_c_stops_a_run_and_progress_is_reported(sand):
    shares = []

    def listener(stage, share):
        shares.append(share)
        if share > 0.0:
            _thread.interrupt_main()

    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        sand.edited(duration=3000.0, forward_speed=0.01).run(progress=listener)
    assert time.monotonic() - begun < 20.0 and 0.0 < shares[-1] < 0.9
    assert sand.edited(duration=0.1).run().channels


def test_a_figure_has_an_axis_for_each_channel(run):
    axes = run.plot(["acceleration_y", "drawbar_pull"])
    assert [ax.get_ylabel() for ax in axes] == ["acceleration [m/s^2]", "drawbar pull $F_{DP}$ [N]"]
    single = run.plot(["sinkage"], ax=axes[0])
    assert single is axes[0]


def test_the_page_of_a_run_is_one_document_that_a_notebook_shows(run, tmp_path):
    page = run.animate()
    text = page.save(tmp_path / "run.html").read_text(encoding="utf-8")
    assert text.lstrip().lower().startswith("<!doctype html>") and "<script" in text
    assert "src=\"http" not in text and page._repr_html_().startswith("<iframe")
