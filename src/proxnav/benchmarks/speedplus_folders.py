"""Where the images and labels of SPEED+ lie: as it is distributed, or as one folder of images beside its labels."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses
from proxnav.datasets.image_folders import camera_beside
from proxnav.errors import InputError
from proxnav.geometry import Camera

DOMAINS = ("lightbox", "sunlamp", "synthetic")
LABELS = ("labels.json", "test.json", "validation.json", "train.json")
"""Files of true poses, the first that is there."""


@dataclass(frozen=True, slots=True)
class Domain:
    """Images of one domain and their true poses."""

    name: str
    folder: Path
    images: list[Path]
    truth: Mapping[str, PoseRecord]
    missing: int
    """Labels whose image is not there."""

    def camera(self) -> Camera:
        """The camera.json beside the images or above them."""
        return camera_beside(self.folder)


def find_domains(root: Path, limit: int = 0) -> list[Domain]:
    """The domains under `root`, or `root` itself where the labels lie in it; InputError where there is none."""
    if not root.is_dir():
        raise InputError(f"--root {root}: no such folder; give that of SPEED+, with {', '.join(DOMAINS)} in it")
    folders = [folder for folder in (root, *sorted(root.iterdir())) if folder.is_dir()]
    labelled = [(folder, labels) for folder in folders if (labels := _labels(folder)) is not None]
    if not labelled:
        raise InputError(
            f"--root {root}: no folder in it has labels ({', '.join(LABELS)}); "
            f"give that of SPEED+, with {', '.join(DOMAINS)}"
        )
    return [_domain(folder, labels, limit) for folder, labels in labelled]


def _labels(folder: Path) -> Path | None:
    return next((folder / name for name in LABELS if (folder / name).is_file()), None)


def _domain(folder: Path, labels: Path, limit: int) -> Domain:
    truth = read_poses(labels)
    places = [place for place in (folder / "images", folder) if place.is_dir()]
    found = {name: path for name in truth for place in places if (path := place / name).is_file()}
    if not found:
        raise InputError(f"{labels}: none of its {len(truth)} images lies in {places[0]}; put them there")
    names = list(found)
    if 0 < limit < len(names):
        names = [names[k] for k in np.linspace(0, len(names) - 1, limit).round().astype(int)]
    name = next((domain for domain in DOMAINS if domain in folder.name), folder.name)
    return Domain(name, folder, [found[n] for n in names], {n: truth[n] for n in names}, len(truth) - len(found))
