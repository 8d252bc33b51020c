"""A whole Trajectory from orbits: what is not given follows declared laws.

Target attitude: LVLH-fixed. Camera attitude: pointing at the target. Sun and eclipse: from the epoch.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import R_eci_lvlh, sun_direction_eci, sun_visible_fraction
from proxnav.geometry.pointing import continuous, q_a_cam_looking
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import Trajectory

Up = Literal["zenith", "forward", "cross_track"]

_FALLBACK: dict[Up, Up] = {"zenith": "forward", "forward": "zenith", "cross_track": "zenith"}


@dataclass(frozen=True)
class PointingConfig:
    """The camera looks at the target's origin."""

    up: Up = "zenith"
    """What is up in the picture: away from Earth, along the flight, or along the orbit's normal."""
    roll_deg: float = 0.0
    """Turn of the camera about its axis."""
    jitter_deg: float = 0.0
    """Standard deviation of the pointing error per axis, drawn anew at every instant."""
    seed: int = 0
    """Seed of the pointing error."""


FARTHEST_M = 1e9
"""Largest coordinate [m]; the Moon is at 4e8 m."""


def assemble(
    epoch_utc: str,
    t: Float[np.ndarray, "n"],
    target: tuple[Vector3, Vector3],
    chaser: tuple[Vector3, Vector3],
    *,
    q_eci_target: QuatWxyz | None = None,
    q_eci_cam: QuatWxyz | None = None,
    pointing: PointingConfig | None = None,
    source: str = "generated",
) -> Trajectory:
    """States (r, v) in ECI [m, m/s] completed by attitudes, Sun vector and eclipse.

    InputError beyond `FARTHEST_M`.
    """
    for r, _ in (target, chaser):
        if not (np.abs(r) < FARTHEST_M).all():
            raise InputError(
                f"a position has a coordinate of {np.abs(r).max():.3g} m, no orbit of Earth; check the unit"
            )
    if q_eci_target is None:
        q_eci_target = q_eci_lvlh(*target)
    if q_eci_cam is None:
        q_eci_cam = point_camera(chaser[0], *target, pointing or PointingConfig())
    sun_eci = sun_direction_eci(epoch_utc, t)
    return Trajectory(
        epoch_utc=epoch_utc,
        t=t,
        r_eci_target_m=target[0],
        v_eci_target_mps=target[1],
        q_eci_target=continuous(q_eci_target),
        r_eci_chaser_m=chaser[0],
        v_eci_chaser_mps=chaser[1],
        q_eci_cam=continuous(q_eci_cam),
        sun_eci=sun_eci,
        sun_visible=np.asarray(sun_visible_fraction(target[0], sun_eci)),
        source=source,
    )


def q_eci_lvlh(r_eci_m: Vector3, v_eci_mps: Vector3) -> QuatWxyz:
    """Attitude of a body whose x flies ahead and whose z points to nadir, (n, 4)."""
    return quaternion.from_matrix(R_eci_lvlh(r_eci_m, v_eci_mps))


def point_camera(r_cam: Vector3, r_target: Vector3, v_target: Vector3, config: PointingConfig) -> QuatWxyz:
    """q_eci_cam of a camera at `r_cam` that looks at `r_target`, up as configured, with roll and jitter.

    InputError where both are one point.
    """
    lvlh = R_eci_lvlh(r_target, v_target)
    axes = {"zenith": -lvlh[..., 2], "forward": lvlh[..., 0], "cross_track": -lvlh[..., 1]}
    ahead = r_target - r_cam
    if not (np.linalg.norm(ahead, axis=-1) > 0.0).all():
        raise InputError("chaser and target are at the same place, no camera can look at the other; check the files")
    look = q_a_cam_looking(ahead, axes[config.up], axes[_FALLBACK[config.up]])
    roll = quaternion.exp(np.array([0.0, 0.0, np.deg2rad(config.roll_deg)]))
    errors = np.random.default_rng(config.seed).normal(size=r_cam.shape) * np.deg2rad(config.jitter_deg)
    return quaternion.multiply(quaternion.multiply(look, roll), quaternion.exp(errors))
