"""The filter on short flights: accuracy, honesty, late and wrong readings, loss and restart."""

from dataclasses import replace
from typing import TypeVar

import numpy as np
import pytest

from navigation.flights import CAMERA, SENSING, TIGHT, filtered, fly, points, reference, without
from proxnav.errors import InputError
from proxnav.evaluation.navigation_errors import NavErrors, mean_nis, nav_errors, outcomes
from proxnav.flight.faults import rows, with_fault
from proxnav.flight.simulate import SimulationConfig, simulate
from proxnav.flight.truth import Truth, TruthConfig, TumbleConfig
from proxnav.flight.truth_files import true_states
from proxnav.geometry import quaternion
from proxnav.navigation.belief import Tracking
from proxnav.navigation.config import FilterNoise, NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.layout import E
from proxnav.navigation.measurements import in_target_axes, lasting_of_keypoints, lasting_of_pose
from proxnav.navigation.navigator import Judged, Navigator, run_filter
from proxnav.navigation.predicted_measurement import predict_measurement
from proxnav.navigation.readings import GnssFix, GyroReading, KeypointFrame, PoseFix, Reading, rank
from proxnav.navigation.smoother import smooth
from proxnav.navigation.stream import readings
from proxnav.records import SensorRecords
from proxnav.targets.loading import load_target
from proxnav.trajectories import ApproachConfig, straight_approach

AnyReading = TypeVar("AnyReading", bound=Reading)
QUARTER = quaternion.exp(np.array([0.0, 0.0, np.pi / 2]))


@pytest.mark.parametrize("coupling", ["tight", "loose"])
def test_errors_settle_within_their_claims(coupling: str) -> None:
    truth, records = fly()
    found, judged, starts = filtered(truth, records, NavigationConfig(coupling=coupling))  # type: ignore[arg-type]
    settled = found.t > 60.0
    assert starts == 1
    assert np.linalg.norm(found.errors[settled, :3], axis=1).max() < 0.2  # m at 30 m
    assert np.rad2deg(np.linalg.norm(found.errors[settled, 6:9], axis=1)).max() < 1.5  # deg
    assert np.nanmean(found.inside_3_sigma) > 0.97
    assert np.nanmean(found.nees) < 25.0  # one run: 12 on average over many
    for kind, (nis, _) in mean_nis(judged, 20.0).items():
        assert 0.7 < nis < 1.3, kind


def test_tight_and_loose_coupling_agree_within_their_claims() -> None:
    truth, records = fly()
    tight = filtered(truth, records)[0]
    loose = filtered(truth, records, NavigationConfig(coupling="loose"))[0]
    difference = np.abs(tight.errors - loose.errors)[-10:]
    assert (difference < 3.0 * np.hypot(tight.sigmas, loose.sigmas)[-10:]).all()


def test_a_fused_pose_is_better_than_a_single_frame() -> None:
    single, fused = [], []
    for seed in range(4):
        truth, records = fly(seed=seed)
        assert records.poses is not None
        found = filtered(truth, records, NavigationConfig(coupling="loose"))[0]
        late = records.poses.t > 60.0
        k = np.round(records.poses.t[late] / truth.step_s).astype(int)
        single.append(quaternion.angle_between(records.poses.q_cam_target[late], truth.q_cam_target[k]))
        fused.append(np.linalg.norm(found.errors[found.t > 60.0, 6:9], axis=1))
    assert np.sqrt(np.mean(np.square(fused))) < 0.8 * np.sqrt(np.mean(np.concatenate(single) ** 2))


def last_of(kind: type[AnyReading], stream: list[Reading]) -> AnyReading:
    return next(reading for reading in reversed(stream) if isinstance(reading, kind))


def final_belief(records, order: np.ndarray | None = None):
    setup = setup_of(records, points(), CAMERA, TIGHT)
    stream = readings(records, setup)
    navigator = Navigator(setup, 0.0)
    for i in range(len(stream)) if order is None else order:
        navigator.receive(stream[int(i)])
    navigator.finish()
    return navigator


def test_readings_in_any_order_within_the_buffer_give_the_same_state() -> None:
    _, records = fly(seconds=14.0)
    setup = setup_of(records, points(), CAMERA, TIGHT)
    count = len(readings(records, setup))
    first = final_belief(records)
    in_time = sorted(range(count), key=lambda i: rank(readings(records, setup)[i]))
    ordered, shuffled = (
        final_belief(records, np.array(in_time)),
        final_belief(records, np.random.default_rng(0).permutation(count)),
    )
    for other in (ordered, shuffled):
        mine, theirs = first.belief, other.belief
        assert isinstance(mine, Tracking)
        assert isinstance(theirs, Tracking)
        np.testing.assert_allclose(theirs.x, mine.x, atol=1e-9)
        np.testing.assert_allclose(theirs.P, mine.P, rtol=1e-6, atol=1e-15)


def test_readings_that_come_twice_or_too_late_or_from_the_future_are_counted_and_left_out() -> None:
    _, records = fly(seconds=60.0)
    setup = setup_of(records, points(), CAMERA, TIGHT)
    stream = readings(records, setup)
    judged: list[Judged] = []
    navigator = Navigator(setup, 0.0, judged.append)
    for reading in stream:
        navigator.receive(reading)
    before = navigator.belief
    last = stream[-1]
    frame = last_of(KeypointFrame, stream)
    assert navigator.receive(frame).verdict.outcome == "duplicate"
    assert navigator.receive(replace(last_of(GnssFix, stream), t=5.3)).verdict.outcome == "late"
    assert navigator.receive(GyroReading(5_000.0, last.received, np.zeros(3), 1.0)).verdict.outcome == "ahead"
    assert navigator.receive(GyroReading(5_000.0, 5_000.0, np.zeros(3), 1.0)).verdict.outcome == "invalid"
    assert navigator.belief is before
    navigator.finish()
    counts = outcomes(judged)
    assert (
        counts["keypoints"]["duplicate"]
        == counts["gnss"]["late"]
        == counts["gyro"]["ahead"]
        == counts["gyro"]["invalid"]
        == 1
    )


def test_swapped_keypoints_are_refused_and_do_no_harm() -> None:
    truth, records = fly()
    broken = with_fault(records, "wrong_frames", np.random.default_rng(1))
    found, judged, starts = filtered(truth, broken)
    refused = outcomes(judged)["keypoints"]["gated"]
    assert 0.15 * 120 < refused < 0.45 * 120
    assert starts == 1
    assert np.nanmean(found.inside_3_sigma[found.t > 30.0]) > 0.97


def test_one_swapped_pair_is_refused_alone() -> None:
    truth, records = fly()
    assert records.keypoints is not None
    pixels = records.keypoints.pixels.copy()
    seen = np.flatnonzero(np.isfinite(pixels[:, :, 0]).all(axis=0))[:2]
    pixels[60:, seen] = pixels[60:, seen[::-1]]
    broken = replace(records, keypoints=replace(records.keypoints, pixels=pixels))
    found, judged, starts = filtered(truth, broken)
    assert outcomes(judged)["keypoints"]["keypoints gated"] >= 2 * 55
    assert starts == 1
    assert np.nanmean(found.inside_3_sigma[found.t > 30.0]) > 0.97


def turned_from(t0: float) -> tuple[Truth, SensorRecords]:
    """A flight whose camera sees the target a quarter turn about z away from `t0` on, and its truth."""
    truth, records = fly()
    k, p = records.keypoints, records.poses
    assert k is not None
    assert p is not None
    pixels = k.pixels.copy()
    for i in np.flatnonzero(k.t > t0):
        j = round(float(k.t[i]) / truth.step_s)
        R = quaternion.to_matrix(quaternion.multiply(truth.q_cam_target[j], QUARTER))
        pixels[i] = CAMERA.project(points() @ R.T + truth.t_cam_target_m[j])
    q = np.where((p.t > t0)[:, None], quaternion.multiply(p.q_cam_target, QUARTER), p.q_cam_target)
    return truth, replace(records, keypoints=replace(k, pixels=pixels), poses=replace(p, q_cam_target=q))


def test_a_free_target_that_is_suddenly_elsewhere_is_lost_and_found_again() -> None:
    truth, broken = turned_from(40.0)
    setup = setup_of(broken, points(), CAMERA, NavigationConfig(coupling="tight", target="free"))
    times = np.arange(5.0, truth.t[-1], 1.0)
    states, _, last = run_filter(broken, setup, times)
    assert last.memory.starts == 2
    seen = [state.status for state in states if state is not None]
    assert "coasting" in seen or "lost" in seen  # it said so
    end = states[-1]
    assert end is not None
    expected = quaternion.multiply(true_states(truth).at(times).q_cam_target[-1], QUARTER)
    assert quaternion.angle_between(end.q_cam_target, expected) < np.deg2rad(2.0)


def test_a_held_target_that_looks_elsewhere_is_not_believed_and_the_filter_says_that_it_is_lost() -> None:
    truth, broken = turned_from(40.0)
    setup = setup_of(broken, points(), CAMERA, TIGHT)
    states, judged, last = run_filter(broken, setup, np.array([39.0, truth.t[-1]]))
    assert last.memory.starts == 1
    assert last.status == "lost"
    assert [state.status for state in states if state is not None] == ["tracking", "suspect"]  # the monitor has seen it
    assert states[-1] is not None
    assert "turned by 90 deg from the attitude that it should hold" in states[-1].cause
    assert outcomes(judged)["poses"]["gated"] > 20  # each pose was offered as a new start


def test_without_camera_the_filter_says_that_it_coasts_and_its_claims_grow() -> None:
    truth, records = fly()
    assert records.keypoints is not None
    blind = replace(
        records, keypoints=rows(records.keypoints, records.keypoints.t < 60.0),
        poses=rows(records.poses, records.poses.t < 60.0) if records.poses else None, gnss=None,
    )  # fmt: skip
    setup = setup_of(blind, points(), CAMERA, TIGHT)
    states, _, _ = run_filter(blind, setup, np.array([58.0, 110.0]))
    before, after = states
    assert before is not None
    assert after is not None
    assert (before.status, after.status) == ("tracking", "coasting")
    assert np.trace(after.covariance[:3, :3]) > np.trace(before.covariance[:3, :3])
    found = nav_errors(states, true_states(truth).at(np.array([58.0, 110.0])))
    assert (found.inside_3_sigma > 0.8).all()


def test_the_accelerometer_in_free_flight_does_harm_and_in_burns_it_helps() -> None:
    sensing = replace(SENSING, gnss="none")
    truth, records = fly(seconds=240.0, sensing=sensing)
    camera = records.keypoints
    assert camera is not None
    blind = replace(records, keypoints=rows(camera, camera.t < 100.0))  # then 140 s of dead reckoning
    gated = filtered(truth, blind)[0]
    naive = filtered(truth, blind, NavigationConfig(coupling="tight", accelerometer="always"))[0]
    assert np.linalg.norm(naive.errors[-1, :3]) > 5.0 * np.linalg.norm(gated.errors[-1, :3])
    assert np.linalg.norm(naive.errors[-1, :3]) > 1.0  # m: 0.05 mg for 140 s


def test_a_burn_is_followed_by_the_accelerometer() -> None:
    sensing = replace(SENSING, gnss="none")
    config = SimulationConfig(TruthConfig(step_s=0.1, burn_interval_s=40.0), sensing)
    path = straight_approach(ApproachConfig((0.0, -45.0, 0.0), (0.0, -29.0, 0.0), 80.0, 5.0))
    truth, records = simulate(path, load_target("space-rider"), CAMERA, config, np.random.default_rng(3))
    felt = filtered(truth, records)[0]
    deaf = filtered(truth, records, NavigationConfig(coupling="tight", accelerometer="never"))[0]
    burned = felt.t == 45.0
    dv = np.linalg.norm(truth.specific_force, axis=1).sum() * truth.step_s
    assert dv > 0.01  # m/s: there was a burn to feel
    assert np.linalg.norm(felt.errors[burned, 3:6]) < 0.5 * np.linalg.norm(deaf.errors[burned, 3:6])


@pytest.mark.parametrize("coupling", ["loose", "tight"])
def test_after_a_time_without_frames_lasting_errors_have_the_size_of_the_new_view(coupling: str) -> None:
    _, records = fly(seconds=60.0)
    setup = setup_of(records, points(), CAMERA, NavigationConfig(coupling=coupling))  # type: ignore[arg-type]
    navigator = Navigator(setup, 0.0)
    stream = readings(records, setup)
    for reading in stream:
        navigator.receive(reading)
    now = navigator.belief
    assert isinstance(now, Tracking)
    blind = replace(now, camera_t=now.t - 5.0 * setup.lasting_tau_s)
    if coupling == "loose":
        pose = last_of(PoseFix, stream)
        seen = lasting_of_pose(blind, in_target_axes(100.0 * pose.covariance, pose.q_cam_target), setup)
    else:
        frame = last_of(KeypointFrame, stream)
        seen = lasting_of_keypoints(blind, replace(frame, covariances_px2=100.0 * frame.covariances_px2), setup)
    grown = np.diagonal(seen.P - now.P)[E.pose_error]
    np.testing.assert_allclose(grown, 99.0 * np.diagonal(now.pose_errors), rtol=0.15)  # nearly the same view
    doubtful = np.flatnonzero(np.diagonal(seen.P))
    np.linalg.cholesky(seen.P[np.ix_(doubtful, doubtful)])


def test_a_jump_of_the_gyro_bias_is_survived() -> None:
    truth, records = fly(seconds=240.0)
    found, _, _ = filtered(truth, with_fault(records, "gyro_step", np.random.default_rng(2)))
    assert found.inside_3_sigma[-10:].mean() > 0.97


def tumbling(inertia_sigma: float) -> tuple[list[NavErrors], list[int]]:
    """Flights round a target whose moments are 5 % off, through a filter that takes them for so uncertain."""
    free = TumbleConfig(rate_deg_s=(0.5, 1.0, 0.3), inertia=(1.0, 3.0, 3.2), inertia_sigma=0.05)
    config = SimulationConfig(TruthConfig(step_s=1.0, tumble=free), SENSING)
    noise = FilterNoise(free_rate=0.05, free_rate_walk=1e-5)
    found, starts = [], []
    for seed in range(3):
        rng = np.random.default_rng(seed)
        truth, records = simulate(reference(150.0), load_target("space-rider"), CAMERA, config, rng)
        navigation = NavigationConfig(target="free", inertia=free.inertia, inertia_sigma=inertia_sigma, noise=noise)
        errors, _, started = filtered(truth, records, navigation)
        found.append(errors)
        starts.append(started)
    return found, starts


def test_a_tumbling_target_is_followed_by_eulers_equations_with_uncertain_moments() -> None:
    found, starts = tumbling(inertia_sigma=0.05)
    assert starts == [1, 1, 1]
    assert max(np.rad2deg(np.abs(errors.errors[-10:, 9:])).max() for errors in found) < 0.1  # deg/s
    assert np.mean([errors.inside_3_sigma[-10:] for errors in found]) > 0.97


def test_a_filter_that_takes_wrong_moments_for_certain_is_not_honest() -> None:
    found, _ = tumbling(inertia_sigma=0.0)
    assert np.mean([errors.nees[-10:] for errors in found]) > 40.0  # of 12


def test_smoothing_is_better_than_filtering_and_as_honest() -> None:
    before, after = [], []
    for seed in range(6):
        truth, records = fly(seed=seed)
        setup = setup_of(records, points(), CAMERA, TIGHT)
        smoothed = [state for state in smooth(records, setup) if 20.0 < state.t < 100.0]
        t = np.array([state.t for state in smoothed])
        after.append(nav_errors(smoothed, true_states(truth).at(t)))
        before.append(nav_errors(run_filter(records, setup, t)[0], true_states(truth).at(t)))
    rms = [np.sqrt(np.mean([np.mean(f.errors**2, axis=0) for f in found], axis=0)) for found in (before, after)]
    assert np.linalg.norm(rms[1][3:6]) < 0.8 * np.linalg.norm(rms[0][3:6])  # m/s
    assert np.linalg.norm(rms[1][9:]) < np.linalg.norm(rms[0][9:])  # rad/s
    for first, last in zip(before, after, strict=True):
        assert (last.sigmas <= first.sigmas * 1.05).mean() > 0.95
    assert 8.0 < np.mean([f.nees.mean() for f in after]) < 17.0


def test_the_predicted_view_holds_the_next_keypoints() -> None:
    truth, records = fly()
    setup = setup_of(records, points(), CAMERA, TIGHT)
    states, _, _ = run_filter(records, setup, np.array([100.0]))
    assert states[0] is not None
    view = predict_measurement(states[0], points(), CAMERA)
    assert view.box_xyxy is not None
    k = round(100.0 / truth.step_s)
    true_px = CAMERA.project(points() @ quaternion.to_matrix(truth.q_cam_target[k]).T + truth.t_cam_target_m[k])
    assert np.linalg.norm(view.keypoints_px - true_px, axis=1).max() < 5.0  # px
    inside = (true_px >= view.box_xyxy[:2] - 0.5) & (true_px <= view.box_xyxy[2:] + 0.5)
    assert inside[CAMERA.contains(true_px)].all()
    assert (view.keypoint_sigma_px < 5.0).all()


def test_records_without_what_the_filter_needs_are_refused_in_a_sentence() -> None:
    _, records = fly()
    with pytest.raises(InputError, match="star tracker"):
        setup_of(without(records, "star_tracker"), points(), CAMERA, TIGHT)
    with pytest.raises(InputError, match="the target has 6"):
        setup_of(records, points()[:6], CAMERA, TIGHT)
    assert records.gyro is not None
    fast = replace(records, gyro=replace(records.gyro, rate=1000.0 * records.gyro.rate))
    with pytest.raises(InputError, match="check the unit of the gyro"):
        setup_of(fast, points(), CAMERA, TIGHT)
    assert records.gnss is not None
    far = replace(records, gnss=replace(records.gnss, position_m=1000.0 * records.gnss.position_m))
    with pytest.raises(InputError, match="check their units"):
        setup_of(far, points(), CAMERA, TIGHT)
