"""Where a frame shows the target: through the arms of both craft, the camera's mounting and its clock."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.rotations import exp, multiply, skew, to_matrix
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.navigation.kernels.orbit import ric_turning
from proxnav.navigation.layout import FRAME, N_POSE, X


@kernel
def true_pose(x, R_eci_ric):
    """(t [m], R) of T_cam_target in the camera's real axes.

    From mass to mass, then out to the target's origin and to the camera: t = R_m^T (R_ct (-g) - R_cr r + b).
    """
    R_cr = to_matrix(x[X.q_eci_cam]).T @ R_eci_ric
    back, R_ct = to_matrix(exp(-x[X.misalignment])), to_matrix(x[X.q_cam_target])
    nominal = x[X.chaser_centre] - R_ct @ x[X.target_centre] - R_cr @ x[X.position]
    return back @ nominal, back @ R_ct


@kernel
def seen_pose(x, R_eci_ric, n, rate_cam):
    """(H of (dt in camera, dr in target axes), t [m], q) of T_cam_target as a frame stamped now shows it.

    RIC turns with n [rad/s], the camera with rate_cam less the gyro's bias. Attitude and the lasting pose error share a
    column: no change of the linearisation point can tell one from the other.
    """
    R_ec, R_ct, back = to_matrix(x[X.q_eci_cam]), to_matrix(x[X.q_cam_target]), to_matrix(exp(-x[X.misalignment]))
    R_cr, centre = R_ec.T @ R_eci_ric, x[X.target_centre]
    between, origin = -R_cr @ x[X.position], -R_ct @ centre
    t = back @ (between + origin + x[X.chaser_centre])
    w_c, w_t = rate_cam - x[X.gyro_bias], x[X.rate]
    moves = -R_cr @ (x[X.velocity] + ric_turning(n) @ x[X.position]) - R_ct @ np.cross(w_t, centre)
    moves = back @ (moves - np.cross(w_c, between + origin))
    turns = w_t - R_ct.T @ w_c
    H = np.zeros((N_POSE, FRAME.pose_error.stop))
    H_t, H_r = H[TRANSLATION], H[ROTATION]
    H_t[:, FRAME.position], H_t[:, FRAME.attitude_cam] = -back @ R_cr, back @ skew(between)
    H_t[:, FRAME.attitude], H_t[:, FRAME.target_centre] = back @ R_ct @ skew(centre), -back @ R_ct
    H_t[:, FRAME.chaser_centre], H_t[:, FRAME.misalignment] = back, skew(t)
    H_t[:, FRAME.pose_translation] = np.eye(3)
    H_r[:, FRAME.attitude], H_r[:, FRAME.pose_rotation] = np.eye(3), np.eye(3)
    H_r[:, FRAME.misalignment] = -(back @ R_ct).T
    H_t[:, FRAME.clock.start], H_r[:, FRAME.clock.start] = -moves, -turns
    late = x[X.clock][0]
    q = multiply(exp(-x[X.misalignment]), x[X.q_cam_target])
    q = multiply(multiply(q, exp(-late * turns)), exp(x[X.pose_rotation]))
    return H, t - late * moves + x[X.pose_translation], q
