"""The navigator as others fly it: reading by reading, with an ephemeris that grows, killed and resumed."""

import json
from pathlib import Path

import numpy as np
import pytest

from navigation.flights import CAMERA, TIGHT, fly, points
from proxnav.cli.main import main
from proxnav.errors import InputError
from proxnav.navigation.belief import Tracking
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import Ephemeris, FilterSetup, filter_setup
from proxnav.navigation.navigator import Navigator, navigated, other_orbit
from proxnav.navigation.readings import GnssFix, Reading
from proxnav.navigation.stream import monitored
from proxnav.records import NavState, SensorRecords

LOOSE = NavigationConfig()


def rows(records: SensorRecords, first: int, last: int) -> Ephemeris:
    e = records.ephemeris
    return Ephemeris(e.t[first:last], e.r_eci_m[first:last], e.v_eci_mps[first:last])


def setup_on_line(records: SensorRecords, config: NavigationConfig) -> FilterSetup:
    """With the first two rows of the ephemeris."""
    return filter_setup(rows(records, 0, 2), points(), CAMERA, config, has_gyro=True, antennas=records.antennas)


def feed(navigator: Navigator, records: SensorRecords, stream: list[Reading], known: int) -> int:
    """Gives readings one by one, and each row of the ephemeris before the readings that it covers."""
    t = records.ephemeris.t
    for reading in stream:
        while known < len(t) and t[known - 1] < reading.t:
            navigator.extend(rows(records, known, known + 1))
            known += 1
        navigator.receive(reading)
    return known


@pytest.mark.parametrize("config", [LOOSE, TIGHT], ids=["loose", "tight"])
def test_on_line_the_states_are_those_of_the_batch(config: NavigationConfig) -> None:
    _, records = fly(seconds=70.0)
    whole = filter_setup(rows(records, 0, 99), points(), CAMERA, config, has_gyro=True, antennas=records.antennas)
    times = np.arange(5.0, 66.0, 5.0)
    batch = navigated(records, whole, times).states
    stream = monitored(records, whole)
    navigator, known, place = Navigator(setup_on_line(records, config), 0.0), 2, 0
    for t, theirs in zip(times.tolist(), batch, strict=True):
        arrived = [reading for reading in stream[place:] if reading.received <= t + 1e-9]
        known, place = feed(navigator, records, arrived, known), place + len(arrived)
        ours = navigator.at(t)
        assert ours is not None
        assert theirs is not None
        np.testing.assert_allclose(vector(ours), vector(theirs), rtol=0.0, atol=1e-9)
        np.testing.assert_allclose(ours.covariance, theirs.covariance, rtol=0.0, atol=1e-9)


def vector(state: NavState) -> np.ndarray:
    return np.concatenate([state.r_ric_m, state.v_ric_mps, state.q_cam_target, state.t_cam_target_m, state.rate_target])


def test_a_killed_and_resumed_navigator_goes_on_with_the_same_bytes(tmp_path: Path) -> None:
    _, records = fly(seconds=70.0)
    setup = setup_on_line(records, LOOSE)
    stream = monitored(records, setup)
    navigator = Navigator(setup, 0.0, other=other_orbit(records))
    half = len(stream) // 2
    known = feed(navigator, records, stream[:half], 2)
    navigator.save(tmp_path / "half.json")
    resumed = Navigator.load(tmp_path / "half.json")
    resumed.save(tmp_path / "again.json")
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "half.json").read_bytes()
    for name, one in (("kept", navigator), ("resumed", resumed)):
        feed(one, records, stream[half:], known)
        one.save(tmp_path / f"{name}.json")
    assert (tmp_path / "kept.json").read_bytes() == (tmp_path / "resumed.json").read_bytes()
    ours, theirs = navigator.belief, resumed.belief
    assert isinstance(ours, Tracking)
    assert isinstance(theirs, Tracking)
    assert np.array_equal(ours.x, theirs.x)
    assert np.array_equal(ours.P, theirs.P)


def test_the_covariance_of_any_instant_is_there_and_grows_ahead() -> None:
    _, records = fly(seconds=40.0)
    setup = setup_on_line(records, LOOSE)
    navigator = Navigator(setup, 0.0)
    stream = monitored(records, setup)
    answers = [navigator.receive(reading) for reading in stream if reading.t <= 29.0]
    last = answers[-1].state
    assert last is not None
    before, now, ahead = (navigator.at(last.t + dt) for dt in (-5.0, 0.0, 30.0))
    assert before is not None
    assert now is not None
    assert ahead is not None
    assert (before.t, now.t, ahead.t) == (last.t - 5.0, last.t, last.t + 30.0)
    assert np.trace(ahead.covariance[:3, :3]) > np.trace(now.covariance[:3, :3])
    assert answers[0].state is None
    assert {answer.verdict.outcome for answer in answers} >= {"accepted", "started"}
    with pytest.raises(InputError, match="extend it first"):
        navigator.at(1e4)
    with pytest.raises(InputError, match="grows forward"):
        navigator.extend(rows(records, 0, 1))


def test_a_fix_of_gnss_without_antennas_is_asked_for_them() -> None:
    _, records = fly(seconds=40.0)
    setup = filter_setup(rows(records, 0, 9), points(), CAMERA, LOOSE, has_gyro=True)
    navigator = Navigator(setup, 0.0)
    stream = monitored(records, setup)
    for reading in stream:
        if not isinstance(reading, GnssFix):
            navigator.receive(reading)
    assert navigator.status == "tracking"
    with pytest.raises(InputError, match="give antennas, or leave GNSS out"):
        navigator.receive(next(reading for reading in stream if isinstance(reading, GnssFix) and reading.t > 30.0))


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ({"version": 9}, "saved with version 1"),
        ({"version": 1, "navigator": {"type": "os:system", "fields": {}}}, "not a"),
        ({"version": 1, "navigator": 3}, "holds no navigator"),
        ({"version": 1, "navigator": {"type": "proxnav.storage.files:write_json", "fields": {}}}, "no record"),
    ],
)  # fmt: skip
def test_a_file_that_holds_no_navigator_is_one_sentence(content: dict, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "navigator.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=sentence):
        Navigator.load(path)


def test_the_example_of_the_api_page_runs_and_is_short(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (Path(__file__).parents[2] / "docs" / "api.md").read_text()
    example = page.split("## On line", 1)[1].split("```python\n", 1)[1].split("```", 1)[0]
    assert len(example.splitlines()) <= 40
    monkeypatch.chdir(tmp_path)
    argv = ["simulate", "--out", "run", "--preset", "hold-30m", "--duration-s", "70", "--truth.step-s", "0.5"]
    assert main(argv) == 0
    found: dict = {}
    exec(compile(example, "docs/api.md", "exec"), found)
    assert found["navigator"].status == "tracking"
    assert found["ahead"].covariance.shape == (12, 12)
