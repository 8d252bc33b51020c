"""Which keypoints a camera sees, against geometry that can be solved by hand and against brute force."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from proxnav.geometry import Pose
from proxnav.targets import Material, Target
from proxnav.targets.assembly import assemble
from proxnav.targets.keypoints.visibility import _every_triangle, first_faces, surface_samples, visible_keypoints
from proxnav.targets.solids import box
from proxnav.targets.space_rider import space_rider


def cube() -> Target:
    keypoints = {"near": (0.0, 0.0, -1.0), "far": (0.0, 0.0, 1.0), "corner": (1.0, 1.0, -1.0), "side": (1.0, 0.0, 0.0)}
    piece = box("cube", (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    return assemble("cube", [piece], {"cube": Material()}, keypoints, {}, "", "")


def test_front_of_a_cube_is_seen_and_its_back_is_not():
    seen = visible_keypoints(cube(), Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 10.0]))
    assert seen.tolist() == [True, False, True, False]


def test_from_behind_it_is_the_other_way_round():
    seen = visible_keypoints(cube(), Pose.from_wxyz("cam", "target", [0, 1, 0, 0], [0, 0, 10.0]))
    assert seen.tolist() == [False, True, False, False]


def test_keypoints_behind_the_camera_are_not_seen():
    seen = visible_keypoints(cube(), Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, -10.0]))
    assert not seen.any()


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.floats(12.0, 500.0))
def test_visibility_is_the_same_at_any_range_along_a_ray_of_sight(seed: int, range_m: float):
    """Convex body: a face that looks at a far camera looks at a farther one on the same line."""
    target = cube()
    q = Rotation.from_rotvec(np.random.default_rng(seed).normal(size=3)).as_quat(scalar_first=True)
    pose = Pose.from_wxyz("cam", "target", q, [0.0, 0.0, range_m])
    eye = pose.inverse().t_m
    outward = np.array([[0, 0, -1.0], [0, 0, 1.0], [0, 0, 0], [1.0, 0, 0]])
    cosine = np.einsum("ij,ij->i", outward, eye - target.keypoints_m) / range_m
    seen = visible_keypoints(target, pose)
    for k in (0, 1, 3):
        if abs(cosine[k]) > 0.02:
            assert seen[k] == (cosine[k] > 0)


def test_embree_agrees_with_every_triangle(rng: np.random.Generator):
    target = space_rider()
    eye = np.array([12.0, -9.0, -7.0])
    points = surface_samples(target, 60, rng)
    direction = (points - eye) / np.linalg.norm(points - eye, axis=1, keepdims=True)
    eyes = np.broadcast_to(eye, points.shape)
    near, face = first_faces(target, eyes, direction)
    slow_near, slow_face = _every_triangle(target)(eyes, direction)
    np.testing.assert_allclose(near, slow_near, atol=1e-4)  # m
    assert (face == slow_face).mean() > 0.95  # shared edges may go either way


def test_wing_tips_are_seen_from_above_and_below_and_the_nose_only_from_ahead():
    target = space_rider()
    tip = target.keypoint_names.index("wing_left_outer_aft")
    nose = target.keypoint_names.index("nose_tip")
    above = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 40.0])
    below = Pose.from_wxyz("cam", "target", [0, 1, 0, 0], [0, 0, 40.0])
    ahead = Pose.from_matrix("cam", "target", [[0, 1, 0], [0, 0, 1], [1, 0, 0]], [0, 0, 40.0])
    behind = Pose.from_matrix("cam", "target", [[0, 1, 0], [0, 0, -1], [-1, 0, 0]], [0, 0, 40.0])
    assert visible_keypoints(target, above)[tip]
    assert visible_keypoints(target, below)[tip]
    assert visible_keypoints(target, behind)[nose]
    assert not visible_keypoints(target, ahead)[nose]


def test_surface_samples_lie_on_the_surface_in_proportion_to_area(rng: np.random.Generator):
    target = cube()
    points = surface_samples(target, 6000, rng)
    np.testing.assert_allclose(np.abs(points).max(axis=1), 1.0, atol=1e-12)
    share = [(np.abs(points[:, axis] - sign) < 1e-9).mean() for axis in range(3) for sign in (-1, 1)]
    np.testing.assert_allclose(share, 1 / 6, atol=0.02)
