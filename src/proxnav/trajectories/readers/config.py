"""What files leave open and the user must or may say."""

from dataclasses import dataclass, field
from typing import Literal

from proxnav.records.scene import Quadruple, Triple
from proxnav.trajectories.generators import DEFAULT_EPOCH
from proxnav.trajectories.orbit import OrbitConfig


@dataclass(frozen=True)
class ReaderConfig:
    """Conventions and roles; None and "" mean that the file has to say it."""

    target: str = ""
    """Name of the target in the files, or the file's name without its ending; by default the first object, in Basilisk
    files the second."""
    chaser: str = ""
    """Name of the chaser; by default the other object."""
    epoch_utc: str = DEFAULT_EPOCH
    """Epoch of tables whose time is elapsed seconds; only Sun and Earth's turn depend on it."""
    columns: tuple[str, ...] = ()
    """Names of the columns of a csv without header, for example t x_1 y_1 z_1 vx_1 vy_1 vz_1."""
    position_unit: str | None = None
    """Unit of length of tables that do not say: m or km; relative positions are metres otherwise."""
    velocity_unit: str | None = None
    """Unit of speed of tables that do not say: m/s or km/s."""
    frame: str | None = None
    """Axes of tables that do not say. Relative to the target: RIC (RTN, RSW, Hill; x radial outward, y in-track, z
    along r x v) or LVLH (VVLH; x ahead, y against r x v, z to nadir). At Earth's centre: ICRF, J2000, Fixed,
    TEMEOfDate or MeanOfDate."""
    quaternion_order: Literal["wxyz", "xyzw"] | None = None
    """Place of the scalar where the file does not say it; MATLAB's Aerospace Toolbox writes wxyz, STK xyzw."""
    quaternion_direction: Literal["reference_to_body", "body_to_reference"] = "reference_to_body"
    """Sense of a table's quaternions: STK, MATLAB's Aerospace Toolbox and Basilisk turn the reference axes into the
    body's."""
    q_chaser_cam: Quadruple | None = None
    """Camera axes to the chaser's body axes, wxyz; None points the camera at the target whatever the file says."""
    chaser_ric_m: Triple = (0.0, -30.0, 0.0)
    """Place of the chaser, held in the target's RIC frame, where no file gives its orbit."""
    target_orbit: OrbitConfig = field(default_factory=OrbitConfig)
    """Orbit of the target where files give relative motion only."""
    target_elements: str = ""
    """The same in one line of classical elements, eccentric ones too, at the first instant:
    "a=6778.137km e=0.001 i=51.6 raan=30 argp=0 nu=10" (degrees; alt= in place of a=, M= or u= in place of nu=)."""
    start_s: float | None = None
    """First instant, seconds past the target file's epoch; None is the first that all files cover."""
    stop_s: float | None = None
    step_s: float | None = None
    """Resamples at this step; None keeps the instants of the target's file."""
