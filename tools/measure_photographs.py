"""Black level, noise, gain, blur, vignetting and saturation of photographs, as a sensor preset needs them.

    python tools/measure_photographs.py FOLDER

Needs no labels: flat dark tiles give black level, noise and vignetting, the strongest edges give the blur. Compressed
pictures (JPEG) lose noise at high spatial frequencies and gain it at block borders, so noise is a lower bound there;
and one picture of a scene gives the gain only as a bound, because structure counts as photon noise.
"""

import sys
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float

from proxnav.images.codecs import read_image
from proxnav.images.tones import grey_8_bit

TILE_PX = 16
EDGE_STEP_DN = 80.0


def main(folder: Path) -> None:
    """Prints a row for each picture and the medians."""
    names = sorted(path for path in folder.iterdir() if path.suffix.lower() in (".jpg", ".jpeg", ".png"))
    if not names:
        sys.exit(f"{folder}: no .jpg or .png; name the folder that holds the photographs")
    print("picture            black [DN]  noise [DN]  corr. next px  border/centre  e-/DN >=  blur [px]  at 255 [%]")
    rows = np.array([_measure(grey_8_bit(read_image(path))) for path in names])
    for name, row in zip([path.name for path in names], rows, strict=True):
        print(_line(name, row))
    print(_line("median", np.nanmedian(rows, axis=0)))
    print("JPEG pictures: noise is a lower bound" if any(p.suffix.lower() != ".png" for p in names) else "lossless")


def _line(name: str, row: Float[np.ndarray, "7"]) -> str:
    black, noise, correlation, border, gain, blur, full = row
    return (
        f"{name:18s} {black:10.1f}  {noise:10.2f}  {correlation:13.2f}  {border:13.3f}  {gain:9.1f}"
        f"  {blur:9.2f}  {100 * full:10.2f}"
    )


def _measure(image: np.ndarray) -> Float[np.ndarray, "7"]:
    grey = image.astype(np.float64)
    tiles, radius = _tiles(grey)
    mean = tiles.mean(axis=(1, 2))
    floor = np.percentile(mean, 5)
    flat = mean < floor + 4.0  # sky without Earth; where Earth fills the picture there are few
    step = np.diff(tiles, axis=2)
    noise = np.median(tiles[flat].std(axis=(1, 2)))
    correlation = 1.0 - np.median((step[flat] ** 2).mean(axis=(1, 2))) / (2.0 * noise**2)
    far, near = flat & (radius > 0.7), flat & (radius < 0.4)
    border = np.median(mean[far]) / np.median(mean[near]) if far.any() and near.any() else np.nan
    return np.array(
        [np.median(mean[flat]), noise, correlation, border, _gain(mean, step), _blur(grey), (image == 255).mean()]
    )


def _tiles(grey: Float[np.ndarray, "h w"]) -> tuple[Float[np.ndarray, "n t t"], Float[np.ndarray, "n"]]:
    """Square tiles of the picture, and their distance from its middle over that of the corners."""
    rows, columns = (size // TILE_PX for size in grey.shape)
    cut = grey[: rows * TILE_PX, : columns * TILE_PX].reshape(rows, TILE_PX, columns, TILE_PX).swapaxes(1, 2)
    v, u = np.meshgrid(np.arange(rows) + 0.5, np.arange(columns) + 0.5, indexing="ij")
    radius = np.hypot(u - columns / 2, v - rows / 2) / np.hypot(columns / 2, rows / 2)
    return cut.reshape(-1, TILE_PX, TILE_PX), radius.ravel()


def _gain(mean: Float[np.ndarray, "n"], step: Float[np.ndarray, "n t s"]) -> float:
    """Electrons for each DN at least: from the growth of the calmest tiles' noise with their level."""
    variance = 0.5 * (step**2).mean(axis=(1, 2))
    levels = np.arange(20.0, 200.0, 15.0)
    calm = [
        (low, np.percentile(variance[inside], 10)) for low in levels if (inside := np.abs(mean - low) < 7.5).sum() > 40
    ]
    if len(calm) < 4:
        return np.nan
    x, y = np.array(calm).T
    slope = np.polyfit(x, y, 1)[0]
    return 1.0 / slope if slope > 0 else np.nan


def _blur(grey: Float[np.ndarray, "h w"]) -> float:
    """Sigma of the sharpest tenth of the strong edges: step / (sqrt(2 pi) x steepest slope), across the edge."""
    smooth = cv2.GaussianBlur(grey, (0, 0), _SMOOTH_PX)
    gx, gy = (
        0.5 * (np.roll(smooth, -1, 1) - np.roll(smooth, 1, 1)),
        0.5 * (np.roll(smooth, -1, 0) - np.roll(smooth, 1, 0)),
    )
    slope = np.hypot(gx, gy)
    reach = np.ones((13, 13), np.uint8)
    step = cv2.dilate(smooth, reach) - cv2.erode(smooth, reach)
    crest = (slope == cv2.dilate(slope, np.ones((5, 5), np.uint8))) & (step > EDGE_STEP_DN)
    crest[:8], crest[-8:], crest[:, :8], crest[:, -8:] = False, False, False, False
    if crest.sum() < 20:
        return np.nan
    sigma = step[crest] / (np.sqrt(2.0 * np.pi) * slope[crest])
    return float(np.sqrt(max(np.percentile(sigma, 25) ** 2 - _SMOOTH_PX**2, 0.0)))


_SMOOTH_PX = 1.0
"""Smoothing before slopes are taken: noise would make them steeper."""

if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) == 2 else sys.exit(__doc__))
