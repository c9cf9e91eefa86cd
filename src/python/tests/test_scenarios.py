import numpy as np
import pytest

import lugwheel as lw


def test_ready_scenarios_are_found_by_name_and_others_by_file(tmp_path, sand):
    assert "single_wheel_st" in lw.scenarios()
    file = sand.save(tmp_path / "my_rig.toml")
    assert lw.scenario(file) == sand and lw.scenario(str(file)).name == "my_rig"


def test_a_short_key_is_the_one_full_key_that_ends_so(sand):
    assert sand.key("slip") == "rig.single_wheel.slip"
    assert sand["slip"] == sand["rig.single_wheel.slip"] == 0.3
    assert sand.edited(wheel__lugs__count=20)["wheel.lugs.count"] == 20
    assert sand.edited({"rig.single_wheel.load": np.float64(60)})["load"] == 60.0
    with pytest.raises(lw.InvalidInput, match="may be .*, .*: write one of them"):
        sand.edited(gain=1.1)


def test_a_wrong_key_or_value_is_refused_with_the_words_of_the_program(sand):
    with pytest.raises(lw.InvalidInput, match="slip"):
        sand.edited(slpi=0.3)
    with pytest.raises(ValueError, match="slip ratio .* must be in") as caught:
        sand.edited(slip=1.3)
    assert caught.value.line is not None
    with pytest.raises(lw.InvalidInput, match="there is no scenario 'sand'"):
        lw.scenario("sand")


def test_effects_are_part_of_a_scenario(sand):
    biased = sand.edited(effects={"gain_error.drawbar_pull": 0.05})
    pull, other = (scenario.run(seed=3)["drawbar_pull"] for scenario in (sand, biased))
    assert np.allclose(other, 1.05 * pull, rtol=1e-3, atol=1e-2)
    assert lw.effects().loc["gain_error.drawbar_pull", "unit"] == "-"


def test_every_key_has_its_unit_and_meaning():
    table = lw.keys()
    assert table.loc["wheel.radius", "unit"] == "m" and table["meaning"].str.len().min() > 3
    assert all("slip" in path for path in lw.keys("slip").index)
    with pytest.raises(lw.InvalidInput, match="slip"):
        lw.keys("slpi")
