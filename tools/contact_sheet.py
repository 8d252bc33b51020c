"""Twelve frames of a data set on one sheet, labels drawn: python tools/contact_sheet.py DATASET OUT.jpg

The counts are linear in the light; for the eye the sheet shows their square root. Green: visible keypoints, red:
hidden ones.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

from proxnav.datasets.set.dataset import Dataset
from proxnav.images.codecs import read_image
from proxnav.records import HIDDEN, VISIBLE
from proxnav.storage.files import inside
from proxnav.viewing.overlay import contact_sheet

_COLOURS = {VISIBLE: (90, 230, 90), HIDDEN: (240, 80, 70)}


def main(source: Path, out: Path) -> None:
    """Draws and writes the sheet."""
    dataset = Dataset(source)
    labels = sorted(dataset.labels, key=lambda label: float(label.T_cam_target.t_m[2]))
    chosen = [labels[i] for i in np.linspace(0, len(labels) - 1, 12).round().astype(int)]
    sheet = contact_sheet([_frame(dataset, label) for label in chosen], columns=4, side=400)
    quality = 90
    while len(encoded := cv2.imencode(".jpg", sheet[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]) > 290_000:
        quality -= 4
    out.write_bytes(encoded.tobytes())


def _frame(dataset: Dataset, label) -> np.ndarray:
    grey = read_image(inside(dataset.folder / "images", label.filename)).astype(np.float64) / 255.0
    canvas = np.repeat((255.0 * np.sqrt(grey)).astype(np.uint8)[..., None], 3, axis=2)
    for (u, v), flag in zip(label.keypoints_px, label.visibility, strict=True):
        if flag in _COLOURS:
            cv2.circle(canvas, (int(u), int(v)), 3, _COLOURS[int(flag)], -1, cv2.LINE_AA)
    text = f"{label.filename}  {np.linalg.norm(label.T_cam_target.t_m):.0f} m"
    cv2.putText(canvas, text, (16, 44), cv2.FONT_HERSHEY_SIMPLEX, 1.1, (255, 255, 255), 2, cv2.LINE_AA)
    return canvas


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
