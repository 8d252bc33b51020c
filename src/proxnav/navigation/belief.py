"""All that the filter believes at one instant, as a value: keeping a belief is keeping a way back to it."""

from dataclasses import dataclass, field

import numpy as np

from proxnav.geometry import Camera, quaternion, so3
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.kernels.orbit import orbit_at
from proxnav.navigation.kernels.prediction import CAMERA_TAU
from proxnav.navigation.layout import FIXED, PUBLISHED
from proxnav.records import NavState, NavStatus


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What does not change during a run."""

    config: NavigationConfig
    camera: Camera
    """Without distortion: pixels are straightened on entry."""
    real_camera: Camera
    points_m: np.ndarray
    """(k, 3) keypoints of the target."""
    ephemeris: tuple[np.ndarray, np.ndarray, np.ndarray]
    """t, r, v of the target in ECI."""
    own_antenna: np.ndarray
    """Of the chaser, camera axes [m]."""
    other_antenna: np.ndarray
    """Of the target, target axes [m]."""
    has_gyro: bool
    R_ric_held: np.ndarray
    """Attitude that a controlled target holds."""
    inertia: np.ndarray
    """Of a free target; zeros where nobody knows."""
    shares: np.ndarray
    """Of the claimed covariance of keypoints: lasting by themselves, new."""
    noise: np.ndarray
    frame_gates: np.ndarray

    @property
    def lens(self) -> np.ndarray:
        """fx, fy, cx, cy."""
        return np.array([self.camera.fx, self.camera.fy, self.camera.cx, self.camera.cy])

    @property
    def camera_errors(self) -> int:
        """How many lasting camera errors the filter carries."""
        return 2 * len(self.points_m) + 6 if self.config.coupling == "tight" else 6

    @property
    def lasting_pose_share(self) -> float:
        """Of the claimed covariance of a pose."""
        noise = self.config.noise
        return noise.camera.pose_share if self.config.coupling == "tight" else noise.poses.lasting_share

    @property
    def lasting_tau_s(self) -> float:
        """How long the camera's errors last."""
        return float(self.noise[CAMERA_TAU])

    def held(self, t: float) -> np.ndarray:
        """(5, 3) how the target is held, as the compiled prediction takes it; zeros for a free target."""
        out, config = np.zeros((5, 3)), self.config.held
        if self.config.target == "held":
            _, _, R_eci_ric, rate = self.orbit(t)
            out[:3] = R_eci_ric @ self.R_ric_held
            out[3] = rate * self.R_ric_held[2]
            out[4, :2] = config.frequency, config.damping
        return out

    def orbit(self, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        """(r, v, R_eci_ric, orbital rate) of the target."""
        return orbit_at(*self.ephemeris, t)


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """The filter's state x with its covariance P (layout: proxnav.navigation.layout), and its memory of events."""

    t: float
    x: np.ndarray | None = None
    """None before the first pose."""
    P: np.ndarray | None = None
    pose_errors: np.ndarray = field(default_factory=lambda: np.zeros((6, 6)))
    """Covariance of the lasting pose errors in frames like the last: dt in camera, dr in target axes."""
    rate_cam: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """Last gyro reading [rad/s]."""
    gyro_t: float = -np.inf
    force_bias: np.ndarray = field(default_factory=lambda: np.zeros(3))
    """Accelerometer bias as met while coasting [m/s^2]."""
    force_count: int = 0
    fix: tuple[float, np.ndarray] | None = None
    """Time and q_eci_cam of the last star tracker fix."""
    frames: tuple[bool, ...] = ()
    """Whether the last frames were accepted, the newest last."""
    camera_t: float = -np.inf
    """Time of the last accepted frame."""
    star_streak: int = 0
    gnss_streak: int = 0
    starts: int = 0
    """How often a pose has started the filter."""
    is_lost: bool = False

    def status(self, config: NavigationConfig) -> NavStatus:
        """What the belief is worth."""
        if self.x is None:
            return "lost" if self.is_lost else "waiting"
        if self.is_lost:
            return "lost"
        return "tracking" if self.t - self.camera_t <= config.loss.coast_after_s else "coasting"


def nav_state(belief: Belief, scene: Scene) -> NavState | None:
    """The belief as others read it; None before the first pose."""
    x, P = belief.x, belief.P
    if x is None or P is None:
        return None
    R_eci_ric = scene.orbit(belief.t)[2]
    R_cam_ric = quaternion.to_matrix(x[6:10]).T @ R_eci_ric
    R_cam_target, t_m = quaternion.to_matrix(x[10:14]), -R_cam_ric @ x[:3]
    G = np.zeros((6, FIXED))
    G[:3, :3], G[:3, 6:9], G[3:, 9:12] = -R_cam_ric, so3.skew(t_m), R_cam_target
    C = G @ P[:FIXED, :FIXED] @ G.T
    return NavState(
        t=belief.t, status=belief.status(scene.config), r_ric_m=x[:3], v_ric_mps=x[3:6],
        q_cam_target=quaternion.normalize(x[10:14]), t_cam_target_m=t_m, rate_target=x[14:17], gyro_bias=x[17:20],
        gnss_bias_m=x[23:26], covariance=P[np.ix_(PUBLISHED, PUBLISHED)], pose_covariance=0.5 * (C + C.T),
    )  # fmt: skip
