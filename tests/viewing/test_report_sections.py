"""Sections of the report that depend on what a run knows: bound and Sun of each frame, a navigation solution."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.evaluation.run_folder import read_run
from proxnav.evaluation.solution_files import read_solution
from proxnav.viewing.report import report_html
from proxnav.viewing.report_filter import filter_section


def _section(page: str, name: str) -> str:
    return page.split(f'<section id="{name}"')[1].split("</section>")[0]


def test_the_bound_is_drawn_where_the_run_knows_it(playable_long: Path) -> None:
    page = report_html(playable_long, "run")
    assert _section(page, "range").count('<path class="bound" d="M') == 3  # two charts and the key
    assert "Cramer-Rao" in _section(page, "range")
    (playable_long / "frames.json").unlink()
    assert "Cramer-Rao" not in report_html(playable_long, "run")


def test_errors_stand_against_the_phase_angle_where_the_run_knows_the_sun(playable_long: Path) -> None:
    section = _section(report_html(playable_long, "run"), "phase")
    assert "phase angle Sun, target, camera [deg]" in section
    assert section.count('<circle class="point"') == 2 * 23  # of 25 one has no pose, one is a half turn
    assert section.count('<path class="outlier"') == 2
    (playable_long / "frames.json").unlink()
    assert 'id="phase"' not in report_html(playable_long, "run")


def test_a_flight_alone_is_a_report(flight: Path) -> None:
    page = report_html(flight, "flight")
    section = _section(page, "filter")
    assert section.count('<path class="band" d="M') == 7  # six charts and the key
    assert 'id="summary"' not in page
    assert 'href="#filter"' in page


def test_shares_inside_3_sigma_are_counted_from_the_solution(flight: Path) -> None:
    solution = read_solution(flight)
    section = filter_section(solution)
    assert section is not None
    for k, row in enumerate(section["rows"]):
        inside = np.abs(solution.errors[:, k]) <= 3.0 * solution.sigma[:, k]
        assert row["inside"] == f"{100.0 * inside.mean():.1f} %"
    rms = float(np.sqrt(np.mean(np.degrees(solution.errors[:, 4]) ** 2)))
    assert float(section["rows"][4]["rms"]) == pytest.approx(rms, rel=1e-3)


def test_estimates_and_a_solution_of_one_run_are_shown_together(playable_long: Path, flight: Path) -> None:
    shutil.copy(flight / "solution.csv", playable_long)
    page = report_html(playable_long, "both")
    assert 'id="summary"' in page
    assert 'id="filter"' in page


def test_a_solution_without_truth_has_no_filter_section(flight: Path, tmp_path: Path) -> None:
    rows = [line.split(",") for line in (flight / "solution.csv").read_text().splitlines()]
    kept = [k for k, name in enumerate(rows[0]) if not re.match(r"error_|nees|inside", name)]
    (tmp_path / "solution.csv").write_text("\n".join(",".join(row[k] for k in kept) for row in rows))
    assert filter_section(read_run(tmp_path).solution) is None
    assert 'id="filter"' not in report_html(tmp_path, "no truth")


@pytest.mark.parametrize(
    "damage", ["", "status,t_s\n", "status,t_s\nok,1\nok\n", "status,t_s\n=1,=2\n", "\x00,\x00\n1,2"]
)
def test_a_damaged_solution_is_one_sentence(damage: str, tmp_path: Path) -> None:
    (tmp_path / "solution.csv").write_text(damage)
    with pytest.raises(InputError) as caught:
        report_html(tmp_path, "broken")
    assert "\n" not in str(caught.value)


def test_markup_in_a_status_of_the_filter_stays_text(flight: Path, tmp_path: Path) -> None:
    text = (flight / "solution.csv").read_text().replace("tracking", "<script>alert(1)</script>")
    (tmp_path / "solution.csv").write_text(text)
    assert "<script>alert" not in report_html(tmp_path, "evil")
