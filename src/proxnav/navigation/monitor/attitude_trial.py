"""Attitude of a controlled target by the poses against the attitude that it is said to hold."""

import numpy as np

from proxnav.geometry import quaternion
from proxnav.geometry.perturbation import ROTATION
from proxnav.navigation.monitor.account import AGREES, NOT_COMPARED, Account, unexplained
from proxnav.navigation.monitor.conventions import Convention, turned_axes
from proxnav.navigation.monitor.evidence import Noise, fit
from proxnav.navigation.monitor.scene import PoseConvention, Scene

KIND = "poses against the held attitude"
_SLACK = np.deg2rad(1.0)
"""Error of mounting and of the held attitude that is nobody's fault."""
_NAMES = ("", *(name for name, _ in turned_axes()))
_AXES = np.array([np.eye(3), *(M for _, M in turned_axes())])
_LEAST_TURN_DEG = 5.0
_STEADY = np.deg2rad(3.0)


def attitude_account(scene: Scene, star: Convention, pose: PoseConvention) -> Account:
    """What the poses say of a controlled target; nothing is compared where it is free."""
    sights, setup = scene.with_star, scene.setup
    if sights is None or setup.config.target == "free":
        return NOT_COMPARED
    q_eci_target = quaternion.multiply(star.read(sights.q_star), pose.read(sights.q_pose, sights.position)[0])
    q_ric = quaternion.multiply(quaternion.conjugate(quaternion.from_matrix(sights.R_eci_ric)), q_eci_target)
    held = quaternion.from_matrix(setup.R_ric_held @ _AXES)
    errors = quaternion.log(quaternion.multiply(quaternion.conjugate(held)[:, None], q_ric))
    found = fit(sights.t, errors, _noise(scene))
    if found is None:
        return NOT_COMPARED
    if not found.refuted():
        return Account(chi2=float(found.chi2[0]))
    angle = np.rad2deg(np.linalg.norm(np.median(errors[0], axis=0)))
    if angle < _LEAST_TURN_DEG:
        return AGREES
    best = int(np.argmin(found.chi2))
    if best and found.fits(best):
        cause = (
            f"the poses show the target turned by {angle:.0f} deg from the attitude that it should hold: axes that are "
            f"permuted, {_NAMES[best]} of the held ones, or a view that is taken for another"
        )
        return Account(1.2, KIND, cause, chi2=float(found.chi2[best]))
    cause = f"the poses show the target turned by {angle:.0f} deg from the attitude that it should hold: give "
    cause += "--filter.held.q-lvlh-target or --filter.target free"
    is_steady = float(np.median(np.abs(errors[0] - np.median(errors[0], axis=0)))) < _STEADY
    return Account(1.6, KIND, cause) if is_steady else unexplained(KIND, cause)


def _noise(scene: Scene) -> Noise:
    sights, setup = scene.with_star, scene.setup
    assert sights is not None
    C = sights.covariance[:, ROTATION, ROTATION]
    size = np.trace(C, axis1=1, axis2=2) / 3.0
    shares = setup.config.noise.poses
    white = np.repeat(shares.white_share * size[:, None], 3, axis=1)
    lasting = (shares.lasting_share + 0.2) * float(np.median(size)) + setup.config.held.sigma**2 + _SLACK**2
    drift = (0.5 * setup.config.held.sigma) ** 2 + 0.3 * shares.lasting_share * float(np.median(size))
    return Noise(white, np.full(3, lasting), drift)
