"""The navigation filter in a loop: what the chaser knows of itself and the poses of its camera in, relative state out.

The target tells nothing: its radial, in-track and cross-track axes are those of the chaser's own orbit, which differ by
the distance over the orbit's radius, 15 microradians at 100 m.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera
from proxnav.geometry.celestial import MU_EARTH
from proxnav.geometry.types import Points, Vector3
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import Ephemeris, filter_setup
from proxnav.navigation.measurements import Verdict
from proxnav.navigation.navigator import Navigator
from proxnav.navigation.readings import Acceleration, GyroReading, PoseFix, StarFix
from proxnav.records import NavState, NavStatus

_ROW_STEP_S = 10.0
_FIRST_STEP_S = 1.0


@dataclass(frozen=True, slots=True, eq=False)
class ChaserState:
    """What the chaser knows of itself at one instant, by its own navigation."""

    t: float
    r_eci_m: Float[np.ndarray, "3"]
    v_eci_mps: Float[np.ndarray, "3"]
    q_eci_cam: Float[np.ndarray, "wxyz=4"]
    rate_cam: Float[np.ndarray, "3"]
    """Inertial rate of the camera, camera axes [rad/s]."""
    gained_cam_mps: Float[np.ndarray, "3"]
    """Velocity gained by thrusters and air since the state before, camera axes; zeros where nobody measures it."""


class RelativeFilter:
    """Camera against target along the chaser's flight; give states and poses in the order of time."""

    def __init__(
        self, points_m: Points, camera: Camera, config: NavigationConfig, attitude_sigma_rad: float = 5e-5
    ) -> None:
        self._points_m, self._camera, self._config = points_m, camera, config
        self._sigma = np.full(3, attitude_sigma_rad)
        self._navigator: Navigator | None = None
        self._last: ChaserState | None = None
        self._row_t = 0.0

    @property
    def status(self) -> NavStatus:
        """What the state is worth."""
        return "waiting" if self._navigator is None else self._navigator.status

    def chaser(self, state: ChaserState) -> None:
        """The chaser's own state: attitude, rate and burns since the state before."""
        navigator = self._with_orbit(state)
        before, self._last = self._last, state
        if before is not None and state.t > before.t:
            step = state.t - before.t
            mean = 0.5 * (before.rate_cam + state.rate_cam)
            navigator.put(GyroReading(state.t, state.t, mean, step))
            if state.gained_cam_mps.any():
                navigator.put(Acceleration(state.t, state.t, state.gained_cam_mps / step, 1.0, step))
        navigator.put(StarFix(state.t, state.t, state.q_eci_cam, self._sigma))

    def pose(self, fix: PoseFix) -> Verdict:
        """A pose of the camera, and what became of it."""
        return Verdict("invalid") if self._navigator is None else self._navigator.receive(fix).verdict

    def at(self, t: float) -> NavState | None:
        """State and covariance at `t` [s]; None before the first pose."""
        return None if self._navigator is None else self._navigator.at(t)

    def _with_orbit(self, state: ChaserState) -> Navigator:
        """The navigator, its ephemeris grown to the state."""
        if self._navigator is None:
            rows = _first_rows(state)
            setup = filter_setup(rows, self._points_m, self._camera, self._config, has_gyro=True)
            self._navigator, self._row_t = Navigator(setup, t0=state.t), float(rows.t[-1])
        elif state.t >= self._row_t + _ROW_STEP_S:
            self._navigator.extend(Ephemeris(np.array([state.t]), state.r_eci_m[None], state.v_eci_mps[None]))
            self._row_t = state.t
        return self._navigator


def _first_rows(state: ChaserState) -> Ephemeris:
    """Two rows of one state: a second of flight under constant gravity is right to millimetres."""
    r, v, dt = state.r_eci_m, state.v_eci_mps, _FIRST_STEP_S
    fall = -MU_EARTH / np.linalg.norm(r) ** 3 * r
    later: tuple[Vector3, Vector3] = (r + dt * v + 0.5 * dt**2 * fall, v + dt * fall)
    return Ephemeris(np.array([state.t, state.t + dt]), np.stack([r, later[0]]), np.stack([v, later[1]]))
