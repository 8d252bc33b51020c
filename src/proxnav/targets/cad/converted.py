"""STEP and USD files as GLB, converted in a process of its own: their native readers may end it on a damaged file."""

import json
import re
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from proxnav.errors import InputError

TIME_LIMIT_S = 1800.0
DEFLECTION_M = 2e-4
"""Largest distance of a triangle from the curved surface of a STEP file that it stands for."""
DEFLECTION_RAD = 0.35
"""Largest angle between neighbouring triangles there."""
_SI = re.compile(rb"SI_UNIT\s*\(\s*(\$|\.[A-Z]+\.)\s*,\s*\.METRE\.\s*\)")
_CONVERSION = re.compile(rb"CONVERSION_BASED_UNIT\s*\(\s*'(INCH|FOOT)", re.IGNORECASE)
_PREFIX_M = {"$": 1.0, ".MILLI.": 1e-3, ".CENTI.": 1e-2, ".DECI.": 0.1, ".KILO.": 1e3, ".MICRO.": 1e-6}
_CONVERSION_M = {b"INCH": 0.0254, b"FOOT": 0.3048}


def step_as_glb(path: Path) -> tuple[bytes, float]:
    """(GLB in metres and the file's axes, metres per unit of the file)."""
    unit_m = _step_unit_m(path)
    content, _ = _converted(path, "step_worker.py", [f"{DEFLECTION_M * 1e3:g}", f"{DEFLECTION_RAD:g}"])
    return content, unit_m


def usd_as_glb(path: Path) -> tuple[bytes, float, str]:
    """(GLB in the stage's unit and axes, metres per unit, up axis)."""
    content, said = _converted(path, "usd_worker.py", [])
    return content, float(said["metres_per_unit"]), str(said["up"])


def check_step(path: Path, size: int) -> None:
    """InputError where cascadio is missing or the file is no STEP."""
    with path.open("rb") as file:
        head = file.read(4096)
    if b"ISO-10303-21" not in head or b"HEADER" not in head:
        raise InputError(f"{path}: {size} bytes that are no STEP file (no ISO-10303-21 header)")
    _need(path, "cascadio", "STEP files are read by cascadio (OpenCASCADE)")


def check_usd(path: Path, size: int) -> None:
    """InputError where usd-core is missing or the file is no USD."""
    with path.open("rb") as file:
        head = file.read(16)
    if not head.startswith((b"#usda", b"PXR-USDC", b"PK\x03\x04")):
        raise InputError(f"{path}: {size} bytes that are no USD file (neither text, crate nor package)")
    _need(path, "pxr", "USD files are read by usd-core")


def _need(path: Path, module: str, sentence: str) -> None:
    if find_spec(module) is None:
        raise InputError(f'{path}: {sentence}, which is not installed; pip install "proxnav[cad]", or export a GLB')


def _step_unit_m(path: Path) -> float:
    """Metres per unit of length that a STEP file declares."""
    content = path.read_bytes()
    converted = _CONVERSION.search(content)
    if converted is not None:
        return _CONVERSION_M[converted.group(1).upper()]
    found = {match.group(1).decode() for match in _SI.finditer(content)}
    units = {_PREFIX_M.get(prefix, -1.0) for prefix in found}
    if len(units) != 1 or min(units) < 0:
        said = ", ".join(sorted(found)) or "none"
        raise InputError(f"{path}: declares no single unit of length (prefixes of the metre: {said}); export it again")
    return units.pop()


def _converted(path: Path, worker: str, words: list[str]) -> tuple[bytes, dict[str, Any]]:
    """(GLB, what the worker says about it)."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.glb"
        command = [sys.executable, str(Path(__file__).with_name(worker)), str(path.resolve()), str(out), *words]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=TIME_LIMIT_S, check=False)
        except subprocess.TimeoutExpired:
            raise InputError(f"{path}: not read within {TIME_LIMIT_S / 60:.0f} minutes; simplify it in CAD") from None
        if done.returncode != 0 or not out.is_file():
            lines = re.sub(r"\x1b\[[0-9;]*m", "", done.stderr or done.stdout).strip().splitlines()
            why = lines[-1][:200] if lines else f"its reader ended with {done.returncode}"
            raise InputError(f"{path}: cannot be read ({why}); export it again")
        last = done.stdout.strip().splitlines()[-1:]
        return out.read_bytes(), json.loads(last[0]) if last and last[0].startswith("{") else {}
