"""What each part of Space Rider is made of, as nominal reflectances.

The tones follow the vehicle's function: black ceramics where re-entry heats, white insulation on the leeside, gold foil
on the module. Reflectances are typical of the material class, not measured on the vehicle.
"""

from proxnav.targets.surface.material import Material

FINISH: dict[str, Material] = {
    "nose_cap": Material("tile", (0.045, 0.045, 0.05), 0.0, 0.45, 1.6),
    "belly": Material("tile", (0.035, 0.035, 0.038), 0.0, 0.50, 1.6),
    "leeside": Material("insulation", (0.78, 0.77, 0.74), 0.0, 0.85, 1.4),
    "cargo_doors": Material("insulation", (0.55, 0.56, 0.57), 0.0, 0.70, 1.4),
    "door_seam": Material("plain", (0.06, 0.06, 0.06), 0.0, 0.8, 1.4),
    "marking_left": Material("plain", (0.02, 0.06, 0.36), 0.0, 0.6, 1.4),
    "body_base": Material("tile", (0.12, 0.12, 0.12), 0.0, 0.6, 1.5),
    "flap_left": Material("plain", (0.05, 0.05, 0.05), 0.0, 0.45, 1.7),
    "flap_right": Material("plain", (0.05, 0.05, 0.05), 0.0, 0.45, 1.7),
    "adapter": Material("foil", (0.86, 0.84, 0.80), 1.0, 0.35, 1.5),
    "module_foil": Material("foil", (0.95, 0.66, 0.26), 1.0, 0.30, 1.5),
    "module_rims": Material("metal", (0.80, 0.80, 0.82), 1.0, 0.35, 1.5),
    "tanks": Material("metal", (0.62, 0.60, 0.57), 1.0, 0.30, 1.5),
    "engine": Material("foil", (0.90, 0.62, 0.25), 1.0, 0.35, 1.5),
    "nozzle": Material("metal", (0.30, 0.28, 0.27), 1.0, 0.45, 1.5),
    "thrusters": Material("metal", (0.55, 0.53, 0.50), 1.0, 0.4, 1.5),
    "wing_cells": Material("solar_cell", (0.020, 0.030, 0.075), 0.0, 0.10, 1.45),
    "wing_backs": Material("plain", (0.62, 0.50, 0.34), 0.0, 0.55, 1.5),
    "wing_frames": Material("metal", (0.70, 0.70, 0.72), 1.0, 0.4, 1.5),
    "wing_drives": Material("metal", (0.75, 0.75, 0.76), 1.0, 0.4, 1.5),
    "wing_yokes": Material("plain", (0.12, 0.12, 0.12), 0.0, 0.5, 1.5),
    "dish": Material("plain", (0.85, 0.85, 0.84), 0.0, 0.5, 1.4),
    "dish_feed": Material("metal", (0.70, 0.70, 0.70), 1.0, 0.4, 1.5),
    "star_trackers": Material("plain", (0.05, 0.05, 0.05), 0.0, 0.7, 1.4),
    "radiator": Material("radiator", (0.84, 0.84, 0.85), 0.0, 0.12, 1.45),
    "low_gain_antenna": Material("plain", (0.75, 0.12, 0.08), 0.0, 0.5, 1.4),
}
