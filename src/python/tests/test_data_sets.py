import numpy as np
import pytest

import lugwheel as lw


def test_a_data_set_holds_every_condition_and_repeat(data_set):
    assert len(data_set) == 18
    windows = data_set.windows
    assert sorted(windows["rig.single_wheel.slip"].unique()) == [0.1, 0.2, 0.3]
    assert set(data_set.splits.columns) >= {"by_run", "by_ground"}


def test_windows_of_a_part_are_samples_with_the_class_of_their_window(data_set):
    parts = {part: data_set.torch(part, split="by_run", window=1.0) for part in ("train", "test")}
    runs = {part: {window.run for window in windows.windows} for part, windows in parts.items()}
    assert not runs["train"] & runs["test"]
    train = data_set.torch(split="by_run", window=1.0, channels=["acceleration_y", "drawbar_pull"])
    samples, label = train[0]
    assert samples.shape == (2, 2000) and samples.dtype == np.float32
    window = train.windows[0]
    run = data_set.runs[window.run]
    assert lw.CLASSES[label] == run.truth["class_windows"][0]["class"]
    assert np.array_equal(samples[1], run["drawbar_pull"][:2000].astype(np.float32))


def test_a_wrong_part_split_or_window_is_refused(data_set):
    for wrong, words in (
        ({"part": "tset", "split": "by_run"}, "has no part 'tset'"),
        ({"split": "by_day"}, "there is no split 'by_day'; there are by_run"),
        ({"split": "by_run", "window": 9.0}, "as long as 9.0 s"),
    ):
        with pytest.raises(lw.InvalidInput, match=words):
            data_set.torch(**wrong)


def test_another_data_set_is_not_written_over_this_one(data_set):
    hard = lw.scenario("single_wheel_ht", duration=2.0)
    with pytest.raises(lw.InvalidInput, match="another data set"):
        lw.sweep(hard, slip=[0.1]).dataset(data_set.folder)
    with pytest.raises(lw.InvalidInput, match="slpi"):
        lw.sweep(hard, slpi=[0.1]).dataset(data_set.folder.with_name("other"))


def test_a_data_set_is_taken_up_where_it_was_stopped(tmp_path):
    hard = lw.scenario("single_wheel_ht", duration=2.0)
    sweep = lw.sweep(hard, slip=[0.0, 0.2], repeats=4)

    def stop(stage, share):
        if share > 0.2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sweep.dataset(tmp_path / "set", jobs=1, progress=stop)
    assert len(sweep.dataset(tmp_path / "set", resume=True)) == 8


def test_torch_takes_the_windows_in_batches_and_workers(data_set):
    torch = pytest.importorskip("torch")
    windows = data_set.torch("train", split="by_run", window=1.0)
    loader = torch.utils.data.DataLoader(windows, batch_size=4, num_workers=2)
    samples, labels = next(iter(loader))
    assert tuple(samples.shape) == (4, 1, 2000) and labels.dtype == torch.int64
