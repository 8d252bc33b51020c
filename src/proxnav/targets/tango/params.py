"""Every main length of the generated Tango, in one place.

A field marked *published* follows from the eleven points that the authors of SPEED+ give; *measured* was read from
pictures of the craft with known pose, to about 5 mm.
"""

from dataclasses import dataclass

from proxnav.errors import InputError

Point = tuple[float, float, float]


@dataclass(frozen=True)
class TangoParams:
    """Lengths [m] of Tango: a flat box under a solar panel that is wider than the box along y, and three antennas.

    >>> TangoParams(cell_rows=15).cell_rows
    15
    """

    half_length_m: float = 0.37
    """Half of the box and of the panel along x. Published."""
    panel_half_width_m: float = 0.385
    """Half of the panel along y. Published."""
    box_low_y_m: float = -0.264
    """Side of the box. Published."""
    box_high_y_m: float = 0.304
    """Side of the box. Published."""
    height_m: float = 0.3215
    """Bottom face to the panel's cells. Published."""
    panel_thickness_m: float = 0.022
    """Measured."""
    plate_m: float = 0.018
    """Thickness of the bottom plate and of the two end plates. Measured."""
    wall_inset_m: float = 0.02
    """How far the foil of the long sides lies behind the plates' edges. Measured."""
    strip_m: float = 0.030
    """Strip without cells along y in the panel's middle. Measured."""
    strip_x_m: float = 0.003
    """Middle of that strip. Measured."""
    cell_rows: int = 17
    """Rows of cells along y. Counted."""
    cell_columns: int = 4
    """Columns of cells on each side of the strip. Counted."""
    cell_width_m: float = 0.0825
    """Pitch along x. Measured."""
    cell_length_m: float = 0.0432
    """Pitch along y. Measured."""
    cells_y_m: float = -0.006
    """Middle of the cells along y. Measured on photographs; the synthetic images of SPEED+ have it at 0."""
    antenna_root_radius_m: float = 0.023
    """Antennas taper to their tips. Measured."""
    antenna_tip_radius_m: float = 0.019
    """Measured."""

    def __post_init__(self) -> None:
        wrong = [name for name in self.__dataclass_fields__ if name.endswith("_m") and name not in _SIGNED]
        wrong = [name for name in wrong if not getattr(self, name) > 0.0]
        if wrong:
            raise InputError(f"Tango's {wrong[0]} must be positive, found {getattr(self, wrong[0]):g}")
        if self.cell_rows < 1 or self.cell_columns < 1:
            raise InputError(
                f"Tango's panel needs at least one row and column, found {self.cell_rows} x {self.cell_columns}"
            )
        if 0.5 * self.cell_rows * self.cell_length_m + abs(self.cells_y_m) > self.panel_half_width_m:
            raise InputError(f"{self.cell_rows} rows of cells do not fit on Tango's panel; lower cell_rows")
        columns = self.cell_columns * self.cell_width_m + self.strip_m / 2 + abs(self.strip_x_m)
        if columns > self.half_length_m:
            raise InputError(
                f"2 x {self.cell_columns} columns of cells do not fit on Tango's panel; lower cell_columns"
            )
        if not self.panel_thickness_m + self.plate_m < self.height_m:
            raise InputError("Tango's plates are thicker than the craft is high; lower panel_thickness_m or plate_m")

    @property
    def panel_bottom_m(self) -> float:
        """z of the panel's underside, where the box ends."""
        return self.height_m - self.panel_thickness_m


_SIGNED = {"box_low_y_m", "strip_x_m", "cells_y_m"}

ANTENNA_TIPS_M: tuple[Point, Point, Point] = (
    (-0.5427, 0.4877, 0.2535),
    (0.5427, 0.4877, 0.2591),
    (0.305, -0.579, 0.2515),
)
"""Published, in their published order."""
ANTENNA_ROOTS_M: tuple[Point, Point, Point] = ((-0.371, 0.385, 0.262), (0.371, 0.385, 0.262), (0.311, -0.386, 0.247))
"""Middle of the rings that hold the antennas. Measured."""
WHIP_ROOTS_M: tuple[Point, Point] = ((-0.388, 0.020, 0.245), (0.388, 0.020, 0.245))
"""Feet of the two thin rods on the end plates. Measured."""
WHIP_TIPS_M: tuple[Point, Point] = ((-0.5455, 0.021, 0.243), (0.5455, 0.021, 0.243))
"""Measured."""
TUBE_M: tuple[Point, Point] = ((-0.394, 0.229, -0.100), (-0.394, 0.229, 0.301))
"""Ends of the tube along the end plate at -x. Measured."""
