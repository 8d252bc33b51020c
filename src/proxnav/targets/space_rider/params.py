"""Every length of the generated Space Rider stack, in one place.

No open source gives a complete set of dimensions, so the stack is parametric. A field marked *published* has an open
source; *derived* comes from the parent vehicle IXV; *assumed* is ours, with its reason.
"""

from dataclasses import dataclass

from proxnav.errors import InputError


@dataclass(frozen=True)
class SpaceRiderParams:
    """Lengths [m] and angles of the stack: lifting body in front, orbital module with two solar wings behind.

    >>> SpaceRiderParams(wing_span_m=12.0).wing_span_m
    12.0
    """

    stack_length_m: float = 8.04
    """Nose tip to nozzle exit. Published: 8.044 m."""
    body_length_m: float = 4.6
    """Re-entry module, nose tip to base. Published: 4.5-4.6 m."""
    body_width_m: float = 2.2
    """Largest width of the lifting body. Derived: IXV is 2.2 m wide."""
    body_height_m: float = 1.4
    """Belly to top. Derived: IXV is about 1.5 m high, Space Rider slightly shorter than IXV."""
    nose_cap_diameter_m: float = 1.30
    """Width at the rim of the ceramic nose dome. Published: 1.30 m."""
    nose_cap_depth_m: float = 0.40
    """Nose tip to the rim of the dome. Assumed: a dome of 0.7 m radius has 0.40 m depth at 1.30 m width."""
    nose_drop_m: float = 0.12
    """Nose tip below the stack's axis. Assumed: lifting bodies carry the stagnation point low, as IXV does."""
    flap_chord_m: float = 0.70
    """Hinge to trailing edge of a body flap. Derived: about 0.9 x 0.7 m each."""
    flap_width_m: float = 0.80
    """Across. Derived: about 0.9 x 0.7 m each, narrowed so that two fit between the rounded chines."""
    flap_gap_m: float = 0.18
    """Between the flaps. Assumed: room for the actuator fairing."""
    flap_thickness_m: float = 0.05
    """Assumed: a stiffened C/SiC shell."""
    flap_deflection_deg: float = 14.0
    """Trailing edge down. Assumed: clears the adapter cone behind the body."""
    door_fore_m: float = 1.55
    """Nose tip to the cargo bay's front edge. Assumed: 1.2 m^3 bay over the centre of mass."""
    door_aft_m: float = 3.45
    """Nose tip to the cargo bay's rear edge. Assumed: as above."""
    module_radius_m: float = 0.95
    """Orbital module. Assumed: it derives from the AVUM+ upper stage, about 2 m across."""
    adapter_radius_m: float = 0.50
    """Adapter at the body's base. Assumed: fits between the flaps and the top of the base."""
    adapter_length_m: float = 0.87
    """Base of the body to the cylinder. Assumed: room for the body flaps."""
    module_length_m: float = 1.75
    """Cylinder of the orbital module. Assumed: what the published stack length leaves after adapter and engine."""
    nozzle_exit_radius_m: float = 0.36
    """Engine bell. Assumed: AVUM-class 2.5 kN engine."""
    nozzle_throat_radius_m: float = 0.11
    """Engine bell. Assumed."""
    wing_span_m: float = 11.2
    """Tip to tip. Assumed: open figures are 10-14 m, of low confidence."""
    wing_root_m: float = 1.75
    """Axis to the inner edge of a wing. Assumed: clears the module by a yoke of 0.8 m."""
    wing_chord_m: float = 2.05
    """Along the stack. Assumed: gives 16 m^2 in all, an open figure of low confidence."""
    wing_thickness_m: float = 0.04
    """Assumed: honeycomb panels with frame."""
    wing_raise_m: float = 0.40
    """Wing plane above the axis. Assumed: the drive units sit on the upper shoulder; it also tells top from bottom."""
    wing_aft_m: float = 0.85
    """Front of the cylinder to the wing axis. Assumed: the middle of the cylinder."""
    panels_per_wing: int = 3
    """Hinged panels of a wing. Assumed."""

    def __post_init__(self) -> None:
        lengths = {k: v for k, v in vars(self).items() if k.endswith("_m") and k != "nose_drop_m"}
        short = [name for name, value in lengths.items() if not 0 < value < 1e3]
        if short:
            raise InputError(f"SpaceRiderParams.{short[0]} is {lengths[short[0]]}; lengths must be positive metres")
        if self.engine_length_m < 0.2:
            raise InputError(
                f"the stack of {self.stack_length_m} m leaves {self.engine_length_m:.2f} m for the engine bell; "
                "shorten body_length_m, adapter_length_m or module_length_m"
            )
        if self.wing_span_m / 2 < self.wing_root_m + 0.1 or self.panels_per_wing < 1:
            raise InputError(f"wing_span_m {self.wing_span_m} leaves no wing outside wing_root_m {self.wing_root_m}")

    @property
    def nose_x_m(self) -> float:
        """Nose tip on the x axis; the origin is half-way between nose tip and nozzle exit."""
        return self.stack_length_m / 2

    @property
    def base_x_m(self) -> float:
        """Rear plane of the lifting body."""
        return self.nose_x_m - self.body_length_m

    @property
    def module_fore_x_m(self) -> float:
        """Front rim of the orbital module's cylinder."""
        return self.base_x_m - self.adapter_length_m

    @property
    def module_aft_x_m(self) -> float:
        """Rear rim of the orbital module's cylinder."""
        return self.module_fore_x_m - self.module_length_m

    @property
    def engine_length_m(self) -> float:
        """Rear rim of the cylinder to the nozzle exit."""
        return self.module_aft_x_m + self.nose_x_m
