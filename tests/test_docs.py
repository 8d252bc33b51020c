"""Numbers and names that the pages repeat are those of the code and of the committed results."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from proxnav.datasets.conversion import FORMATS
from proxnav.datasets.formats import READERS
from proxnav.datasets.sensor_records.record_tables import TABLES
from proxnav.evaluation.recall import LIMITS
from proxnav.evaluation.solution_files import STATE_COLUMNS
from proxnav.records.error_model import KeypointErrorModel, PoseErrorModel

ROOT = Path(__file__).parents[1]


def page(name: str) -> str:
    """Text of a page of docs/."""
    return (ROOT / "docs" / name).read_text(encoding="utf-8")


def numbers_after(text: str, label: str) -> list[float]:
    """Numbers in the row of a table that begins with a label."""
    row = next(line for line in text.splitlines() if line.startswith(f"| {label}"))
    return [float(found) for found in re.findall(r"-?\d+\.?\d*", row.removeprefix(f"| {label}"))]


def spelt_out(names: str) -> set[str]:
    """'r_{x,y}_m' as r_x_m and r_y_m."""
    match = re.search(r"\{([^}]*)\}", names)
    if match is None:
        return {names}
    return {one for word in match[1].split(",") for one in spelt_out(names.replace(match[0], word, 1))}


def documented_columns(text: str) -> set[str]:
    """Every column name in the first two cells of the tables of a text."""
    cells = [cell for line in text.splitlines() if line.startswith("|") for cell in line.split("|")[1:3]]
    words = [word for cell in cells for word in re.split(r",\s+|\s+", cell)]
    return {name for word in words for name in spelt_out(word.strip("`,()"))}


def test_the_shares_of_lasting_errors_are_those_of_the_filter() -> None:
    text, poses, keypoints = page("navigation.md"), PoseErrorModel(), KeypointErrorModel()
    whole = "lasts, of the whole pose: the right shape in a wrong place"
    assert numbers_after(text, whole) == [poses.lasting_share, keypoints.pose_share]
    assert numbers_after(text, "lasts, of each point by itself | - |") == [keypoints.point_share]
    assert numbers_after(text, "new in each frame") == [poses.white_share, keypoints.white_share]
    assert numbers_after(text, "time constant") == [poses.tau_s, keypoints.tau_s]


def test_the_columns_of_a_solution_are_documented() -> None:
    text = page("navigation.md").partition("**solution.csv**")[2].partition("**summary.json**")[0]
    assert set(STATE_COLUMNS) - documented_columns(text) == set()


def test_the_columns_of_the_records_are_documented() -> None:
    text = page("navigation.md").partition("## Records")[2].partition("**solution.csv**")[0]
    known = documented_columns(text)
    for name, table in TABLES.items():
        assert f"`{name}.csv`" in text
        missing = {column for column in table.columns if column not in known and not re.fullmatch(r"c\d\d", column)}
        assert missing == set(), name


def test_the_radial_frame_is_not_called_lvlh() -> None:
    row = next(line for line in page("conventions.md").splitlines() if line.startswith("| `ric`"))
    assert "LVLH" not in row.split("|")[1]


def test_every_format_stands_in_the_table_and_in_the_help() -> None:
    table = page("formats.md").partition("## What each format holds")[2].partition("\n## ")[0]
    named = set(
        re.findall(r"`([a-z0-9+-]+)`", "\n".join(line.split("|")[1] for line in table.splitlines() if "|" in line))
    )
    assert {*READERS, *FORMATS} - named == {"poses", "shards"} - named
    help_text = (ROOT / "src" / "proxnav" / "commands" / "convert.py").read_text(encoding="utf-8")
    listed = help_text.partition('"""proxnav, coco')[2].partition('"""')[0]
    assert all(re.search(rf"(^|[ ,\n]){re.escape(name)}[,;]", "proxnav, coco" + listed) for name in FORMATS)


@pytest.mark.parametrize("limit", LIMITS)
def test_the_limits_of_recall_are_documented(limit: str) -> None:
    assert limit in page("evaluation.md")


def test_table_1_is_the_committed_result() -> None:
    found = json.loads((ROOT / "benchmarks" / "results" / "table1" / "metrics.json").read_text())
    text = page("benchmarks/table1.md")
    row = next(line for line in text.splitlines() if line.startswith("| mean E_T, camera axes"))
    ours = [float(number) for number in row.split("|")[3].split()]
    np.testing.assert_allclose(ours, found["mean_e_t_m"], atol=5.1e-4)
    rows = {"mean E_R [deg]": ("mean_e_r_deg", 3), "mean E_C": ("mean_e_c", 4), "median E_C": ("median_e_c", 4)}
    for label, (key, digits) in rows.items():
        row = next(line for line in text.splitlines() if line.startswith(f"| {label} |"))
        assert float(row.split("|")[3]) == pytest.approx(found[key], abs=0.51 * 10.0**-digits), label


@pytest.mark.parametrize(("count", "solver"), [(n, name) for n in (24, 6) for name in ("proxnav", "opencv", "poselib")])
def test_the_solvers_table_is_the_committed_result(count: int, solver: str) -> None:
    found = json.loads((ROOT / "benchmarks" / "results" / "solve" / "solve.json").read_text())
    one = found[f"{count}_keypoints"][solver]
    row = next(line for line in page("benchmarks/solve.md").splitlines() if line.startswith(f"| {count} | {solver} |"))
    cells = [float(cell) for cell in row.split("|")[3:8]]
    expected = [one["median_us"], one.get("time_over_proxnav", 1.0), one["mean_e_r_deg"], one["median_e_r_deg"]]
    np.testing.assert_allclose(cells[:4], expected, rtol=0.01)
    assert cells[4] == pytest.approx(one["p95_e_r_deg"], rel=0.01)
