"""Offsets of rows and columns are taken out; a scene without them is left alone, to the byte."""

import cv2
import numpy as np
import pytest

from proxnav.images.line_offsets import line_offsets, without_line_offsets


def scene(sky: float = 3.0) -> np.ndarray:
    """A bright textured plate before a sky, with noise of 2 counts."""
    rng = np.random.default_rng(1)
    level = np.full((400, 500), sky)
    texture = cv2.GaussianBlur(rng.normal(0.0, 60.0, (240, 200)), (0, 0), 3.0)
    level[90:330, 150:350] = 110.0 + texture
    return level + rng.normal(0.0, 2.0, level.shape)


def counts(level: np.ndarray) -> np.ndarray:
    return np.clip(np.rint(level), 0, 255).astype(np.uint8)


@pytest.mark.parametrize("sky", [3.0, 60.0])
def test_a_scene_without_offsets_is_the_same_object(sky: float) -> None:
    grey = counts(scene(sky))
    assert without_line_offsets(grey) is grey


@pytest.mark.parametrize("axis", [0, 1], ids=["rows", "columns"])
@pytest.mark.parametrize("sky", [3.0, 60.0])
def test_offsets_are_found_and_taken_out(axis: int, sky: float) -> None:
    level = scene(sky)
    offsets = np.random.default_rng(2).normal(0.0, 6.0, level.shape[axis])
    striped = level + (offsets[:, None] if axis == 0 else offsets[None, :])
    mended = without_line_offsets(counts(striped)).astype(float)
    plate = (slice(92, 328), slice(152, 348))
    before, after = (np.std((one - level)[plate].mean(axis=1 - axis)) for one in (striped, mended))
    assert before > 4.0
    assert after < 0.5 * before


def test_a_picture_of_lines_as_edges_of_a_craft_has_no_offsets() -> None:
    level = np.full((300, 300), 20.0)
    level[60:240:12, 40:260] = 200.0  # ribs over two thirds of the picture
    grey = counts(level + np.random.default_rng(3).normal(0.0, 1.5, level.shape))
    assert line_offsets(grey) is None
    assert without_line_offsets(grey) is grey
