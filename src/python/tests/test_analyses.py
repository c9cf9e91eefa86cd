import numpy as np
import pandas as pd
import pytest

import lugwheel as lw

WHEEL = lw.Wheel(radius=0.14, width=0.15, lugs=28, lug_height=0.015)
LOADS = (60.0, 100.0, 150.0)


@pytest.fixture(scope="module")
def rig():
    """Simulated runs on sand as a user's tables: other names, another unit, one run with dates."""
    tables = []
    for load in LOADS:
        for slip in (0.1, 0.25, 0.4):
            scenario = lw.scenario("single_wheel_st", slip=slip, load=load, duration=8.0, lead_in=4.0)
            run = scenario.run(seed=len(tables) + 1)
            table = run.to_pandas().rename(columns={"normal_force": "Fz"})
            table["az_g"] = table.pop("acceleration_y") / 9.80665
            if not tables:
                table.index = pd.Timestamp("2026-05-01") + pd.to_timedelta(table.index, unit="s")
            columns = {"normal_force": "Fz", "acceleration_y": {"column": "az_g", "unit": "g"}}
            speed = scenario["forward_speed"]
            tables.append(lw.MeasuredRun(table, load=load, speed=speed, slip=slip, columns=columns))
    return lw.campaign(tables, wheel=WHEEL)


def test_a_campaign_of_data_frames_is_a_run_file_in_si_units(rig):
    assert len(rig) == 9 and rig.scenario is None
    table = rig.table()
    assert list(table["load_n"].unique()) == list(LOADS) and set(table["lug_count"]) == {28}
    simulated = lw.scenario("single_wheel_st", slip=0.1, load=60.0, duration=8.0, lead_in=4.0).run(seed=1)
    measured = rig[0].channel("acceleration_y")
    assert measured.unit == "m/s^2" and measured.sample_rate == pytest.approx(2000.0)
    assert np.allclose(measured.samples[:1000], simulated["acceleration_y"][:1000], atol=1e-4)


def test_a_table_that_cannot_be_imported_is_refused_with_its_column(tmp_path):
    table = pd.DataFrame({"time_s": [0.0, 0.1, 0.2], "Fz": [1.0, 2.0, 3.0]})
    with pytest.raises(lw.InvalidInput, match="Fx"):
        lw.campaign([lw.MeasuredRun(table, columns={"normal_force": "Fx"})], wheel=WHEEL)
    with pytest.raises(lw.InvalidInput, match="at least one run"):
        lw.campaign([])


def test_an_inspection_lists_its_findings_and_does_not_raise(rig):
    inspection = rig.inspect()
    assert inspection.is_sound and len(inspection.table) == len(inspection.findings)
    assert set(inspection.channels["channel"]) >= {"drawbar_pull", "sinkage"}


def test_windows_are_recognised_and_scored_where_labels_are(rig, data_set):
    windows = rig.recognize(window=4.0).table
    assert set(windows["class"]) <= set(lw.CLASSES) and (windows["class"] == "LEIS").mean() > 0.5
    scored = data_set.runs.recognize(window=2.0)
    assert 0.0 <= scored.accuracy <= 1.0 and scored.confusion.to_numpy().sum() == len(scored.table)
    scored.plot()


def test_sand_is_identified_with_intervals_that_hold_it(rig):
    fit = rig.identify(terrain_class="LEIS", law="own")
    angle = fit.table.loc[(0, "phi")]
    assert angle["unit"] == "deg" and angle["low"] <= angle["value"] <= angle["high"]
    assert abs(angle["value"] - 31.0) < 6.0
    assert len(fit.rows()) == 9 and {"measured_drawbar_pull", "fitted_load"} <= set(fit.rows().columns)
    axes = fit.plot("drawbar_pull")
    assert axes.get_xlabel() == "slip ratio $s$ [-]"
    known = rig.identify(terrain_class="LEIS", law="own", known={"n0": 1.1}).table.loc[(0, "n0")]
    assert known["value"] == 1.1


def test_a_diagnosis_says_before_it_starts_what_keeps_it(rig, tmp_path):
    sand = lw.scenario("single_wheel_st")
    with pytest.raises(lw.InvalidInput, match="no_such_effect"):
        rig.diagnose(sand, without=["no_such_effect"], bank=tmp_path / "bank", progress=False)
