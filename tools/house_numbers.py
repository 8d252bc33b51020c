"""Numbers of a source tree, as JSON: how much there is, how long its pieces are, what its names and shapes say.

    python tools/house_numbers.py [SRC] [--python PYTHON]

`SRC` is the folder that holds the package `proxnav`, of any checkout; options are counted through the parser of every
command, in an interpreter of their own. Literal indices are subscripts and ranges by numbers of 3 and more: `x[6:10]`,
`P[9:12]`, `range(9, 12)`, `s[15]`; places of a vector of three are no such.
"""

import argparse
import ast
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

STATES = ("navigation", "flight", "rendering/raycast")
"""Rooms whose states are packed into arrays."""
SHAPED = re.compile(r"\b(Float|Float32|Float64|Int|Int32|Int64|UInt8|UInt16|UInt32|Bool|Num|Shaped|Integer)\[")
BARE = re.compile(r"\bnp\.ndarray\b|\bNDArray\b")
COUNT_OPTIONS = """
import contextlib, importlib, io, json, re, warnings, tyro, tyro.extras
warnings.simplefilter("ignore")
class Found(BaseException): pass
def stop(config, *words, **named): raise Found(config)
parser_of = tyro.extras.get_parser
tyro.cli = tyro.extras.get_parser = stop
cli = importlib.import_module("proxnav.cli")
main = cli.main if callable(getattr(cli, "main", None)) else importlib.import_module("proxnav.cli.main").main
def listed(page): return re.findall(r"^  ([a-z][a-z0-9-]*)  ", page, re.M)
def options(parser, seen):
    for action in parser._actions:
        if isinstance(getattr(action, "choices", None), dict):
            for child in action.choices.values(): options(child, seen)
        elif action.option_strings and action.dest != "help": seen.add(max(action.option_strings, key=len))
    return seen
def count(words):
    page = io.StringIO()
    try:
        with contextlib.redirect_stdout(page): main([*words, "--help"])
    except Found as found: return {" ".join(words): len(options(parser_of(found.args[0]), set()))}
    except SystemExit: pass
    parts = {}
    for name in listed(page.getvalue()): parts |= count([*words, name])
    return parts
print(json.dumps(count([])))
"""


def main() -> None:
    """Parses the words and prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, nargs="?", default=Path("src"))
    parser.add_argument("--python", default=sys.executable)
    words = parser.parse_args()
    print(json.dumps(numbers(words.source, words.python), indent=1))


def numbers(source: Path, python: str) -> dict[str, Any]:
    """All of them."""
    root = source / "proxnav"
    texts = {path.relative_to(root).as_posix(): path.read_text() for path in sorted(root.rglob("*.py"))}
    trees = {name: ast.parse(text) for name, text in texts.items()}
    lines = {name: text.count("\n") for name, text in texts.items()}
    options = options_by_command(source, python)
    return {
        "lines_of_src": sum(lines.values()),
        "files": len(lines),
        "longest_file": longest(lines),
        "longest_command": longest({name: n for name, n in lines.items() if name.startswith("commands/")}),
        "lines_of_pipeline": lines.get("pipeline.py"),
        "fan_out_of_pipeline": len(imported(trees["pipeline.py"])) if "pipeline.py" in trees else None,
        "options": sum(options.values()),
        "options_by_command": options,
        "docstrings_that_begin_of": sum(text.startswith("Of ") for tree in trees.values() for text in docstrings(tree)),
        "array_annotations": annotations(trees),
        "function_lines": function_lines(trees),
        "literal_indices": {room: literal_indices(trees, room) for room in STATES},
    }


def longest(lines: dict[str, int]) -> list[str | int]:
    """The file with the most lines, and how many."""
    name = max(lines, key=lines.__getitem__)
    return [name, lines[name]]


def imported(tree: ast.Module) -> set[str]:
    """Modules of proxnav that a module imports."""
    froms = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module}
    plain = {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    return {name for name in froms | plain if name.split(".")[0] == "proxnav"}


def options_by_command(source: Path, python: str) -> dict[str, int]:
    """Options of every command, those of its sub-commands included."""
    done = subprocess.run(
        [python, "-c", COUNT_OPTIONS], env=os.environ | {"PYTHONPATH": str(source.resolve())}, text=True,
        stdout=subprocess.PIPE, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)


def docstrings(tree: ast.Module) -> Iterator[str]:
    """Of modules, classes, functions, and of the fields and constants before them."""
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for line in body if isinstance(body, list) else []:
            if (
                isinstance(line, ast.Expr)
                and isinstance(line.value, ast.Constant)
                and isinstance(line.value.value, str)
            ):
                yield line.value.value


def annotations(trees: dict[str, ast.Module]) -> dict[str, float]:
    """Arrays in signatures and fields, and the share of them whose shape is said."""
    aliases = shaped_aliases(trees)
    named = re.compile(rf"\b({'|'.join(sorted(aliases))})\b") if aliases else re.compile("$^")
    shaped = bare = 0
    for annotation in (ast.unparse(found) for tree in trees.values() for found in annotated(tree)):
        if SHAPED.search(annotation) or named.search(annotation):
            shaped += 1
        elif BARE.search(annotation):
            bare += 1
    return {"all": shaped + bare, "shaped": round(shaped / max(1, shaped + bare), 3)}


def annotated(tree: ast.Module) -> Iterator[ast.expr]:
    """Annotations of arguments, results, fields and variables."""
    for node in ast.walk(tree):
        if isinstance(node, ast.arg | ast.AnnAssign) and node.annotation is not None:
            yield node.annotation
        elif isinstance(node, ast.FunctionDef) and node.returns is not None:
            yield node.returns


def shaped_aliases(trees: dict[str, ast.Module]) -> set[str]:
    """Names that stand for an array with a shape."""
    return {
        target.id
        for name, tree in trees.items()
        if name.endswith("types.py")
        for node in tree.body
        if isinstance(node, ast.Assign) and SHAPED.search(ast.unparse(node.value))
        for target in node.targets
        if isinstance(target, ast.Name)
    }


def function_lines(trees: dict[str, ast.Module]) -> dict[str, float]:
    """Median and 90th percentile of the lines of a function, its docstring included, and the longest."""
    lengths = {
        f"{name}:{node.name}": (node.end_lineno or node.lineno) - node.lineno + 1
        for name, tree in trees.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    }
    values = list(lengths.values())
    return {"median": float(np.median(values)), "p90": float(np.percentile(values, 90)), "longest": max(values)}


def literal_indices(trees: dict[str, ast.Module], room: str) -> int:
    """Subscripts and ranges by numbers of 3 and more."""
    found = 0
    for name, tree in trees.items():
        if name.startswith(room + "/"):
            found += sum(is_literal(node) for node in ast.walk(tree))
    return found


def is_literal(node: ast.AST) -> bool:
    """Whether a node is `x[6:10]`, `P[9, 12]`, `s[15]` or `range(9, 12)`."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "range":
        return (
            len(node.args) == 2 and max((place(arg) for arg in node.args), default=-1) >= 3 and place(node.args[0]) >= 0
        )
    if not isinstance(node, ast.Subscript) or not isinstance(node.value, ast.Name | ast.Attribute):
        return False
    parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    places = [
        place(end) for part in parts for end in ((part.lower, part.upper) if isinstance(part, ast.Slice) else (part,))
    ]
    return max(places, default=-1) >= 3


def place(node: ast.expr | None) -> int:
    """The number that a node is, or -1."""
    return node.value if isinstance(node, ast.Constant) and type(node.value) is int else -1


if __name__ == "__main__":
    main()
