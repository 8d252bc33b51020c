"""A run folder read back has the errors that the room of evaluation computes."""

import shutil

import numpy as np
import pytest

from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.errors import InputError
from proxnav.evaluation.pairing import pair
from proxnav.geometry.perturbation import difference
from proxnav.storage.files import write_json
from proxnav.viewing.run_folder import from_best_to_worst, read_run


def test_errors_are_those_of_the_evaluation(make_run) -> None:
    folder = make_run(20)
    pairs = pair(read_poses(folder / "poses.json"), read_poses(folder / "truth.json"))
    for row, frame in zip(read_run(folder).frames, pairs, strict=True):
        assert (row.filename, row.status, row.errors is None) == (frame.filename, frame.status, frame.errors is None)
        if row.errors is None or frame.errors is None:
            continue
        ours, theirs = row.errors, frame.errors
        np.testing.assert_allclose(ours.e_t_m, theirs.e_t_m, atol=1e-12)  # m
        np.testing.assert_allclose([ours.e_t_norm_m, ours.e_tn], [theirs.e_t_norm_m, theirs.e_tn], rtol=1e-12)
        np.testing.assert_allclose([ours.e_r_rad, ours.e_c], [theirs.e_r_rad, theirs.e_c], rtol=1e-12)
        error = difference(frame.T_est, frame.T_true)
        assert ours.nees == pytest.approx(error @ np.linalg.solve(frame.covariance, error), rel=1e-9)
        np.testing.assert_allclose(ours.normalised, error / np.sqrt(np.diagonal(frame.covariance)), rtol=1e-9)


def test_frames_without_a_pose_come_last(make_run) -> None:
    order = from_best_to_worst(read_run(make_run(8)).frames)
    assert [frame.filename for frame in order[-2:]] == ["000002.png", "000001.png"]  # half turn, then no pose


def test_pictures_run_from_worst_to_best_and_foreign_files_are_left_alone(make_run) -> None:
    folder = make_run(8, pictures=5)
    shutil.copy(folder / "overlays" / "best-0000.png", folder / "overlays" / "sketch.png")
    assert [picture.place for picture in read_run(folder).pictures] == [4, 3, 2, 1, 0]


@pytest.mark.parametrize("name", ["poses.json", "truth.json", "metrics.json"])
def test_a_missing_file_is_named(make_run, name: str) -> None:
    folder = make_run(4)
    (folder / name).unlink()
    with pytest.raises(InputError, match=name):
        read_run(folder)


def test_metrics_that_are_no_object_are_refused(make_run) -> None:
    folder = make_run(4)
    write_json(folder / "metrics.json", [1, 2])
    with pytest.raises(InputError, match=r"metrics\.json"):
        read_run(folder)


def test_an_estimate_without_truth_is_refused(make_run) -> None:
    folder, other = make_run(4), make_run(5)
    shutil.copy(other / "poses.json", folder / "poses.json")
    with pytest.raises(InputError, match=r"000004\.png"):
        read_run(folder)
