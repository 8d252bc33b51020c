"""Sun and Earth of each image."""

from pathlib import Path

import numpy as np
import pytest

from proxnav.datasets.skies import read_skies, sky_of
from proxnav.errors import InputError
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes


def test_a_csv_gives_directions_by_image_and_may_leave_the_nadir_out(tmp_path: Path) -> None:
    path = tmp_path / "sky.csv"
    path.write_text("filename,sun_x,sun_y,sun_z,nadir_x,nadir_y,nadir_z\na.png,0,0,-1,0,1,0\nb.png,1,0,0,,,\n")
    skies = read_skies(path)
    np.testing.assert_array_equal(skies["a.png"].sun_cam, [0.0, 0.0, -1.0])
    np.testing.assert_array_equal(skies["a.png"].nadir_cam, [0.0, 1.0, 0.0])
    assert skies["b.png"].nadir_cam is None


@pytest.mark.parametrize(
    ("text", "sentence"),
    [("name,sun_x\nx,1\n", "needs the columns"), ("filename,sun_x,sun_y,sun_z\nx,0,0,0\n", "row 2.*a direction"),
     ("filename,sun_x,sun_y,sun_z\nx,0,0,up\n", "row 2.*three numbers")],
)  # fmt: skip
def test_what_is_no_sky_is_one_sentence(text: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "sky.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=sentence):
        read_skies(path)


def test_a_scene_knows_its_sun_and_earth_in_camera_axes() -> None:
    scene = draw_scenes(load_mission("observation-10-100m"), 1, seed=4)[0]
    sky = sky_of(scene)
    to_camera = scene.T_cam_target.t_m
    phase = np.arccos(-(sky.sun_cam @ to_camera) / np.linalg.norm(to_camera))
    assert phase == pytest.approx(scene.phase_rad, abs=1e-9)
    assert np.linalg.norm(sky.nadir_cam) > 6.7e6
