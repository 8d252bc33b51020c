"""What each part of Tango is made of, as nominal reflectances.

Tones follow what pictures of the craft show, on an arbitrary scale; they are typical of the material class.
"""

from proxnav.targets.surface.material import Material

FINISH: dict[str, Material] = {
    "bottom_plate": Material("foil", (0.62, 0.60, 0.58), 0.6, 0.45, 1.5),
    "end_plate_back": Material("plain", (0.72, 0.72, 0.72), 0.0, 0.55, 1.5),
    "end_plate_front": Material("plain", (0.72, 0.72, 0.72), 0.0, 0.55, 1.5),
    "foil_sides": Material("foil", (0.85, 0.80, 0.72), 1.0, 0.35, 1.5),
    "panel": Material("plain", (0.36, 0.36, 0.36), 0.0, 0.55, 1.5),
    "cells": Material("plain", (0.020, 0.024, 0.034), 0.0, 0.12, 1.45),
    "antennas": Material("plain", (0.42, 0.42, 0.42), 0.0, 0.5, 1.5),
    "antenna_rings": Material("metal", (0.50, 0.50, 0.50), 1.0, 0.4, 1.5),
    "antenna_mounts": Material("foil", (0.45, 0.44, 0.43), 0.8, 0.45, 1.5),
    "whip_feet": Material("plain", (0.20, 0.20, 0.20), 0.0, 0.5, 1.5),
    "whips": Material("metal", (0.80, 0.80, 0.80), 1.0, 0.4, 1.5),
    "tube": Material("plain", (0.30, 0.30, 0.30), 0.0, 0.5, 1.5),
    "tube_clamps": Material("plain", (0.08, 0.08, 0.08), 0.0, 0.5, 1.5),
    "brackets": Material("plain", (0.12, 0.12, 0.12), 0.0, 0.5, 1.5),
    "radiator": Material("plain", (0.45, 0.45, 0.46), 0.0, 0.4, 1.5),
    "side_unit": Material("plain", (0.35, 0.35, 0.35), 0.0, 0.5, 1.5),
    "edge_unit": Material("metal", (0.85, 0.85, 0.85), 1.0, 0.45, 1.5),
    "bottom_unit": Material("metal", (0.60, 0.60, 0.60), 1.0, 0.4, 1.5),
    "end_camera": Material("plain", (0.40, 0.40, 0.40), 0.0, 0.5, 1.5),
    "thruster_rail": Material("plain", (0.25, 0.25, 0.25), 0.0, 0.5, 1.5),
    "domes": Material("plain", (0.60, 0.60, 0.60), 0.0, 0.5, 1.5),
    "cut_outs": Material("plain", (0.03, 0.03, 0.03), 0.0, 0.7, 1.5),
    "nozzles": Material("metal", (0.45, 0.45, 0.45), 1.0, 0.4, 1.5),
}
