"""GNSS baseline against the camera's: sign, axes, and where the antennas sit."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.perturbation import TRANSLATION
from proxnav.navigation.filter_setup import R_RIC_LVLH, FilterSetup
from proxnav.navigation.monitor.account import NOT_COMPARED, Account, unexplained
from proxnav.navigation.monitor.conventions import Convention
from proxnav.navigation.monitor.evidence import CLEARLY, Fit, Noise, fit
from proxnav.navigation.monitor.scene import PoseConvention, Scene, Sightings

KIND = "GNSS against camera"
_DIRECTION = 0.01
"""Error of the camera's direction that is nobody's fault [rad]: half a degree of mounting."""
_LONGEST_ARM_M = 15.0
_FREE_OFFSET = 10.0
"""Chi-square that an offset which is fitted must gain."""
CAUSES = (
    "", "the GNSS baseline is opposite to the camera's: from the target's antenna to the chaser's is wanted",
    *(f"the GNSS baseline looks given in {axes} axes{way}" for axes in ("RIC", "LVLH", "camera", "target")
      for way in (", not ECI", " and opposite")),
    "the GNSS baseline looks given in kilometres, not metres",
)  # fmt: skip
_COSTS = (0.0, 1.0, *[1.1] * 8, 1.0)


def baseline_account(scene: Scene, star: Convention, pose: PoseConvention, excluded: frozenset[int]) -> Account:
    """What the baseline says under the conventions of star tracker and poses."""
    sights = scene.with_gnss
    found = baseline_fit(scene, star, pose)
    if sights is None or found is None:
        return NOT_COMPARED
    if not found.refuted():
        return Account(chi2=float(found.chi2[0]))
    order = sorted(range(1, len(CAUSES)), key=lambda k: found.chi2[k])
    best = next((k for k in order if k not in excluded), 0)
    if found.fits(best) and found.chi2[0] > found.chi2[best] + CLEARLY:
        return Account(_COSTS[best], KIND, CAUSES[best], chi2=float(found.chi2[best]))
    return _antennas(scene, star, pose)


def baseline_fit(scene: Scene, star: Convention, pose: PoseConvention) -> Fit | None:
    """Chi-square of each of `CAUSES`."""
    sights = scene.with_gnss
    if sights is None or scene.setup.antennas is None:
        return None
    residuals = np.array(list(_residuals(sights, star, pose, scene.setup)))
    return fit(sights.t, residuals, _noise(sights, scene.setup))


def _residuals(
    sights: Sightings, star: Convention, pose: PoseConvention, setup: FilterSetup
) -> Iterator[Float[np.ndarray, "n 3"]]:
    """Baseline less what camera, star tracker and antennas make of it, ECI axes [m], under each hypothesis."""
    q_eci_cam = star.read(sights.q_star)
    q_cam_target, t = pose.read(sights.q_pose, sights.position)
    q_eci_target, (own, other) = quaternion.multiply(q_eci_cam, q_cam_target), setup.arms_m
    seen = quaternion.rotate(q_eci_cam, own - t) - quaternion.rotate(q_eci_target, other)
    d = sights.baseline
    in_ric = np.einsum("nij,nj->ni", sights.R_eci_ric, d)
    in_lvlh = np.einsum("nij,nj->ni", sights.R_eci_ric, d @ R_RIC_LVLH.T)
    for given in (d, in_ric, in_lvlh, quaternion.rotate(q_eci_cam, d), quaternion.rotate(q_eci_target, d)):
        yield given - seen
        yield -given - seen
    yield 1e3 * d - seen


def _noise(sights: Sightings, setup: FilterSetup) -> Noise:
    R = quaternion.to_matrix(sights.q_star)
    C = np.diagonal(R @ sights.covariance[:, TRANSLATION, TRANSLATION] @ np.swapaxes(R, -1, -2), axis1=1, axis2=2)
    shares, range_m = setup.config.noise.poses, float(np.median(np.linalg.norm(sights.position, axis=1)))
    white = sights.gnss_sigma**2 + shares.white_share * C + 1e-4
    lasting = setup.config.noise.gnss_bias_m**2 + np.median(C, axis=0) * (shares.lasting_share + 0.2)
    drift = 0.1 * float(lasting.max()) + (0.1 * _DIRECTION * range_m) ** 2
    return Noise(white, lasting + (_DIRECTION * range_m) ** 2, drift)


def _antennas(scene: Scene, star: Convention, pose: PoseConvention) -> Account:
    """An offset that stays in the target's or the camera's axes, or a contradiction without a name."""
    sights = scene.with_gnss
    assert sights is not None
    residual = next(_residuals(sights, star, pose, scene.setup))
    noise, q_eci_cam = _noise(sights, scene.setup), star.read(sights.q_star)
    q_eci_target = quaternion.multiply(q_eci_cam, pose.read(sights.q_pose, sights.position)[0])
    limit = min(_LONGEST_ARM_M, float(np.median(np.linalg.norm(sights.position, axis=1))))
    for axes, q in (("target", q_eci_target), ("camera", q_eci_cam)):
        offset = np.median(quaternion.rotate(quaternion.conjugate(q), residual), axis=0)
        found = fit(sights.t, (residual - quaternion.rotate(q, offset))[None], noise)
        if found is not None and found.fits(0) and np.linalg.norm(offset) < limit:
            x, y, z = offset
            return Account(
                1.0, KIND, f"the GNSS baseline misses the camera's by ({x:.1f}, {y:.1f}, {z:.1f}) m in {axes} axes: "
                "check where the antennas sit", chi2=float(found.chi2[0]) + _FREE_OFFSET,
            )  # fmt: skip
    return unexplained(
        KIND, "the GNSS baseline contradicts the camera's, and no convention of sign or axes explains it"
    )
