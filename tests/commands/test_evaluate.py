"""`proxnav evaluate` on files."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.evaluation.records import disturbed, truth_along

from proxnav.cli.main import main
from proxnav.datasets.formats.speed_poses import write_poses


@pytest.fixture
def files(tmp_path: Path, rng: np.random.Generator) -> tuple[Path, Path]:
    truth = truth_along(rng, np.linspace(10.0, 100.0, 30))
    estimates = disturbed(truth, 1e-4 * np.eye(6), rng)
    del estimates["img000003.png"]
    write_poses(tmp_path / "poses.json", estimates.values())
    write_poses(tmp_path / "truth.json", truth.values())
    return tmp_path / "poses.json", tmp_path / "truth.json"


def test_json_is_one_object_of_numbers(files: tuple[Path, Path], capsys: pytest.CaptureFixture) -> None:
    assert main(["evaluate", *map(str, files), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert (content["frames"], content["poses"]) == (30, 29)
    assert 0.0 < content["mean_e_t_norm_m"] < 0.05
    assert content["consistency"]["poses"] == 29


def test_tables_are_printed(files: tuple[Path, Path], capsys: pytest.CaptureFixture) -> None:
    assert main(["evaluate", *map(str, files)]) == 0
    printed = capsys.readouterr().out
    assert "29 poses in 30 frames" in printed
    assert "4.302" in printed
    assert "mean NEES" in printed


def test_swapped_files_are_one_sentence(files: tuple[Path, Path], capsys: pytest.CaptureFixture) -> None:
    assert main(["evaluate", str(files[1]), str(files[0])]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "'img000003.png'" in error


@pytest.mark.parametrize("content", ["", "{", "[1, 2]", '{"poses": 3}', '[{"filename": "a.png"}]'])
def test_unusable_files_are_one_sentence(
    content: str, files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    (tmp_path / "broken.json").write_text(content)
    assert main(["evaluate", str(tmp_path / "broken.json"), str(files[1])]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "broken.json" in error


def test_a_missing_file_is_one_sentence(files: tuple[Path, Path], capsys: pytest.CaptureFixture) -> None:
    assert main(["evaluate", "nowhere.json", str(files[1])]) == 1
    assert "nowhere.json" in capsys.readouterr().err


def test_labels_from_the_field_compare_with_themselves(shared_data: Path, capsys: pytest.CaptureFixture) -> None:
    labels = str(shared_data / "speedplus" / "shirt_roe1.json")
    assert main(["evaluate", labels, labels, "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert (content["frames"], content["poses"]) == (2371, 2371)
    assert content["mean_e_c"] < 1e-9
