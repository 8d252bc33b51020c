"""One frame from two states, the Sun and a camera, without a trajectory."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, quaternion
from proxnav.geometry.arrays import frozen
from proxnav.geometry.celestial import sun_direction_eci, sun_visible_fraction
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import SceneSpec, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at


@dataclass(frozen=True, slots=True, eq=False)
class CraftState:
    """Where a craft is and how it is turned, in ECI (J2000)."""

    r_eci_m: Float[np.ndarray, "3"]
    """Position of the target's origin, or of the camera's centre [m]."""
    v_eci_mps: Float[np.ndarray, "3"]
    """Velocity [m/s]."""
    q_eci_body: Float[np.ndarray, "wxyz=4"]
    """Attitude of the target's axes, or of the camera's (x right, y down, z forward), scalar first."""

    def __post_init__(self) -> None:
        for name, shape in (("r_eci_m", (3,)), ("v_eci_mps", (3,)), ("q_eci_body", (4,))):
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))


def scene_from_states(
    target: CraftState, camera_state: CraftState, camera: Camera, epoch_utc: str, *, target_name: str = "space-rider",
    sun_eci: Vector3 | None = None, config: SceneConfig | None = None, index: int = 0, seed: int = 0,
) -> SceneSpec:  # fmt: skip
    """The scene of one frame at `epoch_utc`, as a renderer takes it.

    `sun_eci` is the unit vector from Earth to the Sun; None: that of the epoch. (seed, index) fix the noise of the
    exposure. The camera's own turning is none: one instant does not show it.
    """
    sun = sun_direction_eci(epoch_utc, np.zeros(1))[0] if sun_eci is None else np.asarray(sun_eci, dtype=np.float64)
    sun = sun / np.linalg.norm(sun)
    instant = Trajectory(
        epoch_utc=epoch_utc, t=np.zeros(1),
        r_eci_target_m=target.r_eci_m[None], v_eci_target_mps=target.v_eci_mps[None],
        r_eci_chaser_m=camera_state.r_eci_m[None], v_eci_chaser_mps=camera_state.v_eci_mps[None],
        q_eci_target=_unit(target.q_eci_body), q_eci_cam=_unit(camera_state.q_eci_body), sun_eci=sun[None],
        sun_visible=np.atleast_1d(sun_visible_fraction(target.r_eci_m[None], sun[None])), source="two states",
    )  # fmt: skip
    return scene_at(
        instant, 0, index=index, target=target_name, camera=camera, config=config or SceneConfig(), seed=seed
    )  # fmt: skip


def _unit(q: QuatWxyz) -> QuatWxyz:
    return quaternion.normalize(q)[None]
