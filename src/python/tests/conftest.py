import matplotlib
import pytest

import lugwheel as lw

matplotlib.use("Agg")


@pytest.fixture(scope="session")
def sand():
    return lw.scenario("single_wheel_st", slip=0.3, duration=4.0)


@pytest.fixture(scope="session")
def run(sand):
    return sand.run(seed=1)


@pytest.fixture(scope="session")
def data_set(tmp_path_factory):
    hard = lw.scenario("single_wheel_ht", duration=2.0, forward_speed=0.04)
    sweep = lw.sweep(hard, slip=[0.1, 0.2, 0.3], load=[80.0, 120.0], repeats=3)
    return sweep.dataset(tmp_path_factory.mktemp("sets") / "hard", jobs=2)
