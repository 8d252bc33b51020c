"""Shows that two source trees give the same results, through nothing but the command line.

    python tools/same_results.py prepare GOLDEN --source OLD/src       once: Cycles frames, flights, keypoints
    python tools/same_results.py capture OLD.out --golden GOLDEN --source OLD/src
    python tools/same_results.py capture NEW.out --golden GOLDEN --source NEW/src
    python tools/same_results.py compare OLD.out NEW.out

`--source` is the folder that holds the package `proxnav`, of any checkout; `--python` an interpreter that has its
libraries. Both trees estimate, solve and filter the very same recorded inputs, so that a difference is found where it
arises. `compare` prints for each part whether the bytes are equal and the largest difference of any number, relative
to numbers above one, and fails above 1e-9; frames and records must be equal to the byte. Files that describe the run
itself (config.json, pictures, parquet) are not compared. `--parts` names some of them, `compare` takes what both have.

Compiled code is cached by the contents of the sources: numba itself would not notice a change in a function that
another file's compiled function calls.
"""

import argparse
import csv
import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

BOUND = 1e-9
START = (
    "import importlib, sys; cli = importlib.import_module('proxnav.cli');"
    "main = cli.main if callable(getattr(cli, 'main', None)) else importlib.import_module('proxnav.cli.main').main;"
    "sys.exit(main())"
)
"""The command line of either layout: `proxnav/cli.py`, or `proxnav/cli/main.py`."""
SEEDS = (100, 300)
"""Of the frames of Table 1."""
FRAME_SETS = {
    "observation-512": "--preset observation-10-100m --frames 36 --seed 7 --size 512",
    "observation-full": "--preset observation-10-100m --frames 8 --seed 8",
    "study-512": "--preset study --frames 4 --seed 9 --size 512",
    "spiral-512": "--preset spiral-10-100m --frames 4 --seed 10 --size 512",
    "far-512": "--preset sroc-200-350m --frames 4 --seed 11 --size 512",
    "colour-512": "--preset study --frames 4 --seed 12 --size 512 --sensor cmv4000-class-colour",
}
"""60 ray-cast frames."""
FLIGHTS = {
    "spiral": ["--preset spiral-10-100m --duration-s 900 --seed 1"],
    "approach": ["--preset approach-100-10m --duration-s 900 --seed 2"],
    "hold": ["--preset hold-30m --duration-s 600 --seed 3"],
    "closed": [f"--preset spiral-10-100m --start-s 4600 --duration-s 20 --seed 4 {camera}"
               for camera in ("--camera raycast", "--detector raycast")],
}  # fmt: skip
"""Spellings of the same flight, of which a tree knows one."""
FILTERS = {
    "loose": ["--smooth"],
    "tight": ["--smooth --filter.coupling tight", "--smooth --coupling tight"],
    "free": ["--filter.target free --filter.no-gyro", "--target-motion free --no-gyro"],
}
LEARNING = "--side 64 --validation 4 --training.loop.steps 3 --training.loop.batch-size 4 --training.loop.log-every 1"
NUMBERS = {".json", ".csv", ".jsonl"}
LEFT_OUT = {"config.json", "data.json"}


@dataclass(frozen=True)
class Tree:
    """A source tree and the interpreter that runs it."""

    python: str
    source: Path

    def run(self, *spellings: str, log: Path) -> None:
        """The first spelling of a command that the tree understands; what it printed lies in `log`."""
        for words in spellings:
            log.parent.mkdir(parents=True, exist_ok=True)
            with log.open("w") as file:
                code = subprocess.run(
                    [self.python, "-c", START, *words.split()], env=self._environment(), stdout=file, stderr=file
                ).returncode
            if code == 0:
                return
        raise SystemExit(f"proxnav {words} ended with {code}:\n{log.read_text()[-2000:]}")

    def _environment(self) -> dict[str, str]:
        digest = hashlib.sha256()
        for path in sorted(self.source.rglob("*.py")):
            digest.update(str(path).encode() + path.read_bytes())
        cache = Path.home() / ".cache" / "proxnav-same-results" / digest.hexdigest()[:16]
        alone = {"OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
        return os.environ | alone | {"PYTHONPATH": str(self.source.resolve()), "NUMBA_CACHE_DIR": str(cache)}


def prepare(tree: Tree, golden: Path) -> None:
    """Records what both trees will read; a part that is there stays."""
    for seed in SEEDS:
        words = f"render --preset observation-10-100m --frames 100 --seed {seed} --out {golden}/images/seed-{seed}"
        tree.run(words, log=golden / "log" / f"cycles-{seed}.txt")
    fly(tree, golden, golden / "flights")
    draw_keypoints(golden / "images" / "seed-100", golden / "keypoints.json")


def fly(tree: Tree, golden: Path, out: Path) -> None:
    """Sensor records of every flight."""
    for name, spellings in FLIGHTS.items():
        words = [f"simulate {flight} --out {out / name}" for flight in spellings]
        tree.run(*words, log=out / f"{name}.txt")


def draw_keypoints(images: Path, out: Path) -> None:
    """True keypoints of a data set with 1.5 px of noise, a sixth of them anywhere: what `solve` reads."""
    rng, truth = np.random.default_rng(5), json.loads((images / "annotations.json").read_text())
    names = {image["id"]: image["file_name"] for image in truth["images"]}
    found = []
    for label in truth["annotations"]:
        points = np.array(label["keypoints"], dtype=float).reshape(-1, 3)
        wrong = rng.random(len(points)) < 1 / 6
        points[:, :2] += rng.normal(0.0, 1.5, (len(points), 2))
        points[wrong, :2] = rng.uniform(0.0, 1024.0, (int(wrong.sum()), 2))
        points[:, 2] = rng.uniform(0.3, 1.0, len(points))
        found.append({"file_name": names[label["image_id"]], "keypoints": points.ravel().tolist()})
    out.write_text(json.dumps(found))


def draw_frames(tree: Tree, golden: Path, out: Path) -> None:
    """The ray caster's frames and their labels."""
    for name, words in FRAME_SETS.items():
        tree.run(f"render --renderer raycast {words} --out {out / name}", log=out / f"{name}.txt")


def draw_with_cycles(tree: Tree, golden: Path, out: Path) -> None:
    """A few small frames by Blender."""
    words = f"render --preset observation-10-100m --frames 3 --size 256 --samples 4 --seed 13 --out {out / 'three'}"
    tree.run(words, log=out / "three.txt")


def estimate(tree: Tree, golden: Path, out: Path) -> None:
    """Poses of Table 1's frames, by one thread."""
    for seed in SEEDS:
        images = golden / "images" / f"seed-{seed}"
        words = f"estimate {images} --model space-rider --threads 1 --out {out}/poses-{seed}.json"
        tree.run(words, log=out / f"{seed}.txt")


def solve(tree: Tree, golden: Path, out: Path) -> None:
    """Poses of recorded keypoints."""
    camera = golden / "images" / "seed-100" / "camera.json"
    words = f"solve {golden}/keypoints.json --camera {camera} --target space-rider --out {out}/poses.json"
    tree.run(words, log=out / "solve.txt")


def navigate(tree: Tree, golden: Path, out: Path) -> None:
    """Solutions of the recorded flights, by each way of filtering."""
    for flight in FLIGHTS:
        for name, spellings in FILTERS.items():
            folder = out / f"{flight}-{name}"
            words = [f"navigate {golden / 'flights' / flight} {how} --out {folder}" for how in spellings]
            tree.run(*words, log=out / f"{flight}-{name}.txt")


def learn(tree: Tree, golden: Path, out: Path) -> None:
    """Weights after three steps on crops drawn on line."""
    tree.run(f"train heatmap {LEARNING} --out {out / 'crop'}", log=out / "crop.txt")


PARTS: dict[str, Callable[[Tree, Path, Path], None]] = {
    "frames": draw_frames, "cycles": draw_with_cycles, "poses": estimate, "solve": solve, "flights": fly,
    "solutions": navigate, "learning": learn,
}  # fmt: skip
BYTES = {"frames", "cycles", "flights"}
"""Parts that must be equal to the byte."""


def capture(tree: Tree, golden: Path, out: Path, parts: list[str]) -> None:
    """Results of a tree; those that lie there already are made again."""
    for part in parts:
        print(part, flush=True)
        if (out / part).exists():
            shutil.rmtree(out / part)
        (out / part).mkdir(parents=True)
        PARTS[part](tree, golden, out / part)


def compare(a: Path, b: Path, parts: list[str]) -> bool:
    """Prints a line for each part that both have; whether all of them agree."""
    good = True
    for part in parts:
        if (a / part).is_dir() and (b / part).is_dir():
            good &= compare_part(part, a / part, b / part)
    return good


def compare_part(part: str, a: Path, b: Path) -> bool:
    """Prints what differs between two folders of results."""
    ours, theirs = files(a), files(b)
    alone = sorted(set(ours) ^ set(theirs))
    both = sorted(set(ours) & set(theirs))
    far = {name: distance(ours[name], theirs[name]) for name in both if not same_bytes(ours[name], theirs[name])}
    worst = max(far.values(), default=0.0)
    good = not alone and worst <= BOUND and not (part in BYTES and far)
    state = f"{len(far)} differ, largest difference {worst:.2e}" if far else "identical bytes"
    print(f"{'same' if good else 'DIFFERENT':<9}  {part:<9}  {len(ours)} files, {state}")
    for name in () if good else alone:
        print(f"           only on one side: {name}")
    for name, how_far in [] if good else far.items():
        print(f"           {name}: {how_far:.2e}")
    return good


def same_bytes(a: Path, b: Path) -> bool:
    """Whether two files have one SHA-256."""
    return hashlib.sha256(a.read_bytes()).digest() == hashlib.sha256(b.read_bytes()).digest()


def files(folder: Path) -> dict[str, Path]:
    """What is compared, by its path."""
    kinds = NUMBERS | {".png", ".safetensors"}
    paths = (p for p in sorted(folder.rglob("*")) if p.suffix in kinds and p.name not in LEFT_OUT)
    return {str(p.relative_to(folder)): p for p in paths if p.name != "errors.png"}


def distance(a: Path, b: Path) -> float:
    """Largest difference of the numbers of two files, over the number where that is above one; infinite for words."""
    if a.suffix not in NUMBERS:
        return math.inf
    ours, theirs = list(leaves(read(a))), list(leaves(read(b)))
    if len(ours) != len(theirs):
        return math.inf
    return max((apart(x, y) for x, y in zip(ours, theirs, strict=True)), default=0.0)


def read(path: Path) -> Any:
    """The values of a file of numbers."""
    if path.suffix == ".csv":
        return list(csv.reader(path.read_text().splitlines()))
    return json.loads(path.read_text()) if path.suffix == ".json" else [json.loads(x) for x in path.open()]


def leaves(value: Any) -> Iterator[float | str]:
    """Numbers and words of nested values, in order."""
    if isinstance(value, dict):
        for key in sorted(value):
            yield key
            yield from leaves(value[key])
    elif isinstance(value, list):
        for item in value:
            yield from leaves(item)
    else:
        try:
            yield float(value)
        except (TypeError, ValueError):
            yield str(value)


def apart(x: float | str, y: float | str) -> float:
    """Difference of two leaves."""
    if x == y or (isinstance(x, float) and isinstance(y, float) and math.isnan(x) and math.isnan(y)):
        return 0.0
    if isinstance(x, str) or isinstance(y, str) or not (math.isfinite(x) and math.isfinite(y)):
        return math.inf
    return abs(x - y) / max(1.0, abs(x))


def main() -> None:
    """Parses the words."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("job", choices=["prepare", "capture", "compare"])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--golden", type=Path)
    parser.add_argument("--source", type=Path, default=Path("src"))
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--parts", nargs="+", choices=list(PARTS), default=list(PARTS))
    words = parser.parse_args()
    tree = Tree(words.python, words.source)
    if words.job == "prepare":
        prepare(tree, words.folders[0])
    elif words.job == "capture":
        capture(tree, words.golden, words.folders[0], words.parts)
    elif not compare(words.folders[0], words.folders[1], words.parts):
        raise SystemExit("results differ")


if __name__ == "__main__":
    main()
