"""What compiled code was made from: numba itself looks at the file of a compiled function, not at what it calls."""

import hashlib
import re
from functools import cache
from pathlib import Path

_IMPORTS = re.compile(r"^from proxnav\.([\w.]+) import (\([^)]*\)|.*)", re.MULTILINE)
_COMPILES = "from proxnav.geometry.compiled.kernel import"


@cache
def digest(path: Path, package: Path) -> bytes:
    """SHA-256 over a file of compiled functions, the files of `package` that it imports from, and so on through those
    that hold compiled functions themselves."""
    source = path.read_text(encoding="utf-8")
    total = hashlib.sha256(source.encode())
    if _COMPILES in source:
        for imported in sorted(_imported(source, package) - {path}):
            total.update(digest(imported, package))
    return total.digest()


def _imported(source: str, package: Path) -> set[Path]:
    """Files named by the import statements: a module, a package, or modules of a package."""
    found = set()
    for module, names in _IMPORTS.findall(source):
        place = package.joinpath(*module.split("."))
        choices = [place.with_suffix(".py"), place / "__init__.py"]
        choices += [place / f"{name}.py" for name in re.findall(r"\w+", names)]
        found |= {choice for choice in choices if choice.is_file()}
    return found
