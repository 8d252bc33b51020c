"""The step that lays a predicted view onto the picture."""

import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import difference, moved
from proxnav.pose.align.photometric import PhotometricEquations, PredictedView, photometric_equations

SIDE = 96
CAMERA = Camera(SIDE, SIDE, 120.0, 120.0, SIDE / 2, SIDE / 2)
TRUTH = moved(Pose.identity("cam", "target"), np.array([0.1, -0.2, 9.0, 0.2, -0.3, 0.1]))
WEAK = 1e-6 * np.eye(6)


def view_of_a_painted_plate(T: Pose) -> PredictedView:
    """A plate in the target's xy plane, wider than the view, under smooth paint."""
    rows, columns = np.indices((SIDE, SIDE)) + 0.5
    rays = CAMERA.unproject(np.stack([columns, rows], axis=-1))
    normal = T.R[:, 2]
    along = (normal @ T.t_m) / (rays @ normal)
    on_plate = (rays * along[..., None] - T.t_m) @ T.R
    inside = np.ones((SIDE, SIDE), bool)
    x, y = on_plate[..., 0], on_plate[..., 1]
    paint = 1.2 + np.sin(2.1 * x + 0.3) * np.cos(1.7 * y) + 0.4 * np.sin(3.0 * y + x)
    depth = along * rays[..., 2]
    return PredictedView(T, CAMERA, paint, depth, inside)


def aligned(start: Pose, seen: np.ndarray, steps: int) -> tuple[Pose, PhotometricEquations]:
    pose = start
    for _ in range(steps):
        equations = photometric_equations(view_of_a_painted_plate(pose), seen, 3.0)
        assert equations is not None
        pose = equations.step(pose, start, WEAK)
    return pose, equations


def test_steps_lead_to_the_pose_whose_view_is_the_picture():
    start = moved(TRUTH, np.array([0.06, -0.05, 0.2, 0.02, -0.03, 0.025]))
    seen = 40.0 * view_of_a_painted_plate(TRUTH).light + 7.0  # another exposure, a black level
    once, _ = aligned(start, seen, 1)
    often, _ = aligned(start, seen, 8)
    before, after, last = (np.abs(difference(pose, TRUTH)) for pose in (start, once, often))
    assert np.linalg.norm(after) < 0.6 * np.linalg.norm(before)
    assert (last < [0.004, 0.004, 0.02, 0.003, 0.003, 0.002]).all()


def test_a_sure_prior_holds_the_pose_and_its_covariance():
    start = moved(TRUTH, np.array([0.05, 0.0, 0.0, 0.0, 0.0, 0.01]))
    seen = view_of_a_painted_plate(TRUTH).light * 50.0
    equations = photometric_equations(view_of_a_painted_plate(start), seen, 3.0)
    assert equations is not None
    sure = 1e12 * np.eye(6)
    assert np.abs(difference(equations.step(start, start, sure), start)).max() < 1e-4
    assert np.allclose(equations.covariance(sure), 1e-12 * np.eye(6), rtol=1e-3, atol=1e-16)
    wide = np.diag(equations.covariance(WEAK))
    assert (wide > 1e-12).all()
    assert (wide < 1e6).all()


def test_white_pixels_and_a_view_of_nothing_say_nothing():
    view = view_of_a_painted_plate(TRUTH)
    assert photometric_equations(view, np.full((SIDE, SIDE), 255.0), 3.0) is None
    nothing = PredictedView(TRUTH, CAMERA, view.light, view.depth_m, np.zeros((SIDE, SIDE), bool))
    assert photometric_equations(nothing, view.light * 50.0, 3.0) is None
