"""Run by `converted.py` in a process of its own: a STEP file as GLB, in metres."""

import sys

import cascadio


def main(source: str, out: str, deflection_mm: str, deflection_rad: str) -> None:
    """Writes the GLB: triangles that stay within a distance and an angle of the surfaces."""
    if cascadio.step_to_glb(source, out, float(deflection_mm), float(deflection_rad)) != 0:
        raise SystemExit("no solids or surfaces that OpenCASCADE can mesh")


if __name__ == "__main__":
    main(*sys.argv[1:])
