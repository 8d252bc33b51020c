"""Whether the filter is honest on truth that another simulator made, row by row: what it assumes, and what it does not.

A row flies a craft that differs from what the filter is told in one thing; the filter has its defaults, but for whether
the target is held and, where a row says so, its moments of inertia.
"""

from dataclasses import replace

from proxnav.benchmarks.outside_flight import OutsideFlight
from proxnav.flight.sensors.detector import DetectorConfig
from proxnav.flight.simulate import SensingConfig
from proxnav.navigation.config import NavigationConfig
from proxnav.records.error_model import PoseErrorModel

_PLAIN = OutsideFlight()
_TUMBLING = replace(_PLAIN, tumble_deg_s=1.0)
_WHITE = SensingConfig(detector=DetectorConfig(pose_errors=PoseErrorModel(lasting_share=0.0, white_share=1.0)))
_SHORT = SensingConfig(detector=DetectorConfig(pose_errors=PoseErrorModel(tau_s=30.0)))
_HELD, _FREE = NavigationConfig(), NavigationConfig(target="free")
_KNOWN = replace(_FREE, inertia=_PLAIN.inertia)

ROWS: dict[str, tuple[OutsideFlight, NavigationConfig]] = {
    "circular, as assumed": (_PLAIN, _HELD),
    "e = 0.01": (replace(_PLAIN, eccentricity=0.01), _HELD),
    "tumbling, inertia given": (_TUMBLING, _KNOWN),
    "GNSS out": (replace(_PLAIN, fault="gnss_lost"), _HELD),
    "camera out": (replace(_PLAIN, fault="camera_lost"), _HELD),
    "camera 2 s late": (replace(_PLAIN, fault="late_camera"), _HELD),
    "every tenth frame half-turned": (replace(_PLAIN, fault="half_turned"), _HELD),
    "camera 1 m from the centre of mass": (replace(_PLAIN, chaser_centre_cam_m=(0.6, 0.0, -0.8)), _HELD),
    "origin 0.54 m off, tumbling": (replace(_TUMBLING, target_centre_m=(0.5, -0.15, 0.13)), _KNOWN),
    "camera turned by 0.2 deg": (replace(_PLAIN, misalignment_deg=0.2), _HELD),
    "tumbling, inertia not given": (_TUMBLING, _FREE),
    "white pose errors": (replace(_PLAIN, sensing=_WHITE), _HELD),
    "camera clock 0.5 s off, tumbling": (replace(_TUMBLING, camera_clock_s=0.5), _KNOWN),
    "e = 0.1": (replace(_PLAIN, eccentricity=0.1), _HELD),
    "800 km": (replace(_PLAIN, perigee_m=800e3), _HELD),
    "drag 3 x": (replace(_PLAIN, air=3.0), _HELD),
    "tumbling, a flat body": (replace(_TUMBLING, inertia=(1000.0, 1100.0, 1900.0)), _FREE),
    "tumbling at 3 deg/s": (replace(_TUMBLING, tumble_deg_s=3.0), _FREE),
    "both arms and the clock, tumbling": (
        replace(_TUMBLING, target_centre_m=(-0.3, 0.1, 0.3), chaser_centre_cam_m=(0.1, 0.2, -0.3), camera_clock_s=-0.2),
        _FREE,
    ),
    "white pose errors, tumbling": (replace(_TUMBLING, sensing=_WHITE), _KNOWN),
    "pose errors that last 30 s": (replace(_PLAIN, sensing=_SHORT), _HELD),
}
"""By what is flown."""
