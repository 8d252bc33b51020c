"""A known mesh followed from image to image by its outline: no network, one pose to begin with."""

from dataclasses import dataclass

import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import ROTATION, TRANSLATION, difference
from proxnav.geometry.types import GreyImage, Image, PoseCovariance
from proxnav.images.acceptance import as_grey
from proxnav.pose.align import AlignConfig, Prior
from proxnav.pose.track.motion import Motion
from proxnav.pose.track.search import STEP_RAD, Laid, laid, searched
from proxnav.records.estimates import PoseResult, PoseStatus
from proxnav.targets import Target

# Chosen on ray-cast frames of Hubble, the ISS and Space Rider: docs/benchmarks/live.md.
LEAST_SHARE, USUAL_SHARE = 0.45, 0.8
"""Share of the outline on edges below which a pose is refused: in itself, and over what this track usually has."""
LEAD = 0.05
"""Score by which a pose that was searched for must be better than any other."""
_BEYOND_RAD, _BEYOND_SHARE, _BEYOND_SIGMAS = np.deg2rad(4.0), 0.04, 4.0
"""Turn, shift as a share of the range, and standard deviations beyond the prediction at which a pose is refused."""
_BEYOND_MOST_RAD = np.deg2rad(45.0)
"""Turn beyond the prediction at which a pose is refused however little is known: a search reaches half as far."""
_CLOSE_RAD = np.deg2rad(6.0)
"""Standard deviation of the predicted attitude up to which its own neighbourhood is enough to look at."""
_WIDEST_RAD = np.deg2rad(24.0)
"""Reach of the widest search."""
_LOOK_ROUND = 10
"""Frames after which the neighbourhood is searched even where nothing speaks against the pose."""
_FIRST = 4
"""Frames at the beginning of a track whose neighbourhood is searched: a first pose may lie in the wrong valley."""
_MEMORY = 0.1
"""Weight of a frame in the usual share of the outline on edges."""


@dataclass(frozen=True, slots=True)
class Start:
    """How far the first pose is known, one standard deviation."""

    sigma_rad: float = float(np.deg2rad(5.0))
    """Attitude about each axis."""
    depth_share: float = 0.03
    """Place along the line of sight, as a share of the range; a quarter of it across."""

    def covariance(self, T_cam_target: Pose) -> PoseCovariance:
        """Covariance of (dt [m], dr [rad]) of a first pose, camera axes."""
        depth = self.depth_share * float(np.linalg.norm(T_cam_target.t_m))
        return np.diag(np.array([depth / 4.0, depth / 4.0, depth, *[self.sigma_rad] * 3]) ** 2)


class Tracker:
    """`tracker(image, camera, t)` is the pose of the target at `t` [s], found near where its motion leads.

    A pose whose outline is not on the image's edges, that breaks with the motion, or that another one rivals is none:
    status `lost` or `ambiguous`. The tracker then goes on along the motion and looks ever farther round it.
    """

    def __init__(self, target: Target, begin: Motion, config: AlignConfig | None = None) -> None:
        self._target, self._config = target, config or AlignConfig()
        self.motion = begin
        """The last motion that an image confirmed."""
        self.misses = 0
        """Frames since a pose was found."""
        self._usual: float | None = None
        self._unsearched = 0
        self._found_in = 0

    @staticmethod
    def from_pose(target: Target, T_cam_target: Pose, t: float, start: Start | None = None) -> "Tracker":
        """A tracker that begins with one pose at `t` [s]."""
        return Tracker(target, Motion.begun(t, T_cam_target, (start or Start()).covariance(T_cam_target)))

    def __call__(self, image: Image, camera: Camera, t: float) -> PoseResult:
        """The pose in an image (uint8 or uint16, grey or RGB) taken at `t` [s], or the reason why there is none."""
        grey, predicted = as_grey(image, camera), self.motion.at(t)
        found, status = self._found(grey, camera, predicted)
        if found is None or status != "ok":
            self.misses += 1
            return PoseResult.failure(status, 0)
        covariance = self._config.covariance_scale * found.covariance
        self._confirm(predicted, found, covariance)
        return PoseResult("ok", found.T_cam_target, covariance, np.zeros(0, bool))

    def restart(self, T_cam_target: Pose, covariance: PoseCovariance, t: float) -> None:
        """Begins anew with a pose that somebody else found, a network for one."""
        self.motion, self.misses, self._usual, self._unsearched = Motion.begun(t, T_cam_target, covariance), 0, None, 0
        self._found_in = 0

    def _found(self, grey: GreyImage, camera: Camera, predicted: Motion) -> tuple[Laid | None, PoseStatus]:
        """The pose near the prediction, or the best of a search round it."""
        prior = _prior(predicted)
        near = laid(grey, camera, self._target, prior) if predicted.turn_sigma_rad <= _CLOSE_RAD else None
        sound = near is not None and self._is_sound(near, predicted)
        self._unsearched += 1
        if sound and self._found_in >= _FIRST and self._unsearched < _LOOK_ROUND:
            return near, "ok"
        self._unsearched = 0
        reach = float(np.clip(2.0 * predicted.turn_sigma_rad, STEP_RAD, _WIDEST_RAD))
        best = searched(grey, camera, self._target, prior, reach)
        if near is not None and sound and (best is None or best.score <= near.score + LEAD):
            return near, "ok"
        if best is None or not self._is_sound(best, predicted):
            return None, "lost"
        return (best, "ok") if best.lead > LEAD else (None, "ambiguous")

    def _is_sound(self, found: Laid, predicted: Motion) -> bool:
        """Whether the image shows the pose's outline, where the motion may lead."""
        usual = 0.0 if self._usual is None else USUAL_SHARE * self._usual
        away = difference(predicted.T_cam_target, found.T_cam_target)
        range_m = float(np.linalg.norm(found.T_cam_target.t_m))
        shift = np.sqrt(np.linalg.eigvalsh(predicted.pose_covariance[TRANSLATION, TRANSLATION])[-1])
        return bool(
            found.edge_share >= max(LEAST_SHARE, usual)
            and np.linalg.norm(away[ROTATION])
            <= np.clip(_BEYOND_SIGMAS * predicted.turn_sigma_rad, _BEYOND_RAD, _BEYOND_MOST_RAD)
            and np.linalg.norm(away[TRANSLATION]) <= max(_BEYOND_SHARE * range_m, _BEYOND_SIGMAS * shift)
        )

    def _confirm(self, predicted: Motion, found: Laid, covariance: PoseCovariance) -> None:
        """The motion and the usual share after a pose was found."""
        self.motion = predicted.corrected(found.T_cam_target, covariance)
        self.misses = 0
        self._found_in += 1
        share = found.edge_share
        self._usual = share if self._usual is None else self._usual + _MEMORY * (share - self._usual)


def _prior(predicted: Motion) -> Prior:
    """The prediction as the alignment takes it."""
    return Prior.of(predicted.T_cam_target, predicted.pose_covariance)
