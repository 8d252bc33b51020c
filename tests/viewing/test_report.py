"""The report says what the run says, whatever the files are called."""

import json
import re

import numpy as np
import pytest

from proxnav.evaluation.error_tables import STUDY as STUDY_OF_EVALUATION
from proxnav.evaluation.run_folder import read_run
from proxnav.storage.files import write_json
from proxnav.viewing.report import STUDY, coverage, flattened, headline, report_html


def _rows(page: str, section: str) -> list[list[str]]:
    part = page.split(f'<section id="{section}"')[1].split("</section>")[0].split("<tbody>")[1]
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.findall(r"<tr.*?>(.*?)</tr>", part)]


def test_the_study_is_the_one_of_the_evaluation() -> None:
    assert STUDY == STUDY_OF_EVALUATION


def test_headline_holds_study_mean_and_interval(make_run) -> None:
    folder = make_run(30)
    metrics = json.loads((folder / "metrics.json").read_text())
    rows = {row["label"]: row for row in headline(metrics)}
    turn = rows["mean E_R"]
    assert turn["study"] == "4.302"
    assert float(turn["ours"]) == pytest.approx(metrics["mean_e_r_deg"], rel=1e-3)
    assert turn["interval"].split(" to ")[0] == f"{metrics['intervals']['mean_e_r_deg'][0]:.4g}"
    assert float(rows["mean E_T, z (forward)"]["ours"]) == pytest.approx(metrics["mean_e_t_m"][2], rel=1e-3)


def test_numbers_that_are_not_there_are_dashes() -> None:
    assert all(row["ours"] == "–" and row["interval"] == "–" for row in headline({"mean_e_c": None, "intervals": 3}))


def test_frames_without_pose_and_half_turns_are_counted(make_run) -> None:
    counts = coverage(read_run(make_run(30)).frames)
    assert list(counts.values()) == ["30", "29", "1 (1 no_consensus)", "1"]


def test_each_frame_has_a_row_with_its_numbers(make_run) -> None:
    folder = make_run(30)
    rows = _rows(report_html(folder, "run"), "frames")
    assert [row[0] for row in rows] == [f"{k:06d}.png" for k in range(30)]
    assert rows[1][1] == "no_consensus"
    assert rows[1][4:] == ["–"] * 7
    errors = read_run(folder).frames[5].errors
    assert errors is not None
    assert float(rows[5][7]) == pytest.approx(errors.e_t_norm_m, rel=1e-3)
    assert float(rows[5][8]) == pytest.approx(np.degrees(errors.e_r_rad), rel=1e-3)


def test_markup_in_names_titles_and_settings_stays_text(make_run) -> None:
    evil = '"><script>alert(1)</script><img src=x onerror=alert(2)>.png'
    folder = make_run(4, names=[evil, "b.png", "c.png", "</title></svg>.png"])
    write_json(folder / "config.json", {"<b>": {"x": "<script>alert(3)</script>"}})
    page = report_html(folder, "<script>alert(4)</script>")
    assert page.count("<script>") == 1  # the page's own
    for tag in ("<script>alert", "<img src=x", "<b>.x", "</title></svg>"):
        assert tag not in page
    assert "&lt;script&gt;alert(4)" in page


def test_the_page_asks_for_nothing_outside_itself(make_run) -> None:
    page = report_html(make_run(12), "run")
    addresses = re.findall(r"""(?:src|href)=["']([^"']*)""", page)
    assert all(address.startswith(("data:", "#")) for address in addresses)
    assert "default-src 'none'" in page
    assert not re.search(r"url\(|@import|https?://", page)


def test_every_picture_and_chart_has_words(make_run) -> None:
    page = report_html(make_run(12, pictures=6), "run")
    gallery = page.split('id="gallery"')[1].split("</section>")[0]
    assert len(re.findall(r'<img [^>]*alt="Overlay of frame \d+ of 12', gallery)) == 6
    assert page.count('role="img" aria-label="') == 3


def test_a_run_without_covariances_pictures_or_config_is_still_a_report(make_run) -> None:
    folder = make_run(6, pictures=0)
    records = json.loads((folder / "poses.json").read_text())
    write_json(folder / "poses.json", [record | {"covariance": None} for record in records])
    page = report_html(folder, "bare")
    assert "The run folder holds no overlays" in page
    assert 'id="calibration"' not in page
    assert 'id="config"' not in page


def test_a_run_without_any_pose_is_still_a_report(make_run) -> None:
    folder = make_run(3)
    write_json(folder / "poses.json", [])
    assert "3 missing" in report_html(folder, "nothing found")


def test_config_is_flattened_to_dotted_names() -> None:
    config = {"camera": {"fx": 1.5, "distortion": [0, 1]}, "seed": None}
    assert list(flattened(config)) == [("camera.fx", "1.5"), ("camera.distortion", "0, 1"), ("seed", "None")]


@pytest.mark.slow
def test_a_thousand_frames_with_noisy_pictures_stay_below_15_mb(make_run) -> None:
    page = report_html(make_run(1000, side=1024, pictures=30), "long")
    assert 1e6 < len(page.encode()) < 15e6


def test_protection_levels_make_a_stanford_diagram(make_run) -> None:
    folder = make_run(12)
    records = json.loads((folder / "poses.json").read_text())
    trust = {"verdict": "verified", "similarity": 0.9, "hazard": 0.01, "p_value": None, "risk": 1e-3}
    levels = {"protection_m": [1e-9, 5e3, 5e3], "protection_rad": [9.0, 9.0, 9.0]}
    write_json(folder / "poses.json", [one | {"trust": trust | levels} for one in records])
    page = report_html(folder, "run")
    posed = sum(frame.T_est is not None for frame in read_run(folder).frames)
    assert f"Stanford diagram, m: {posed} of {posed} poses exceed their level" in page
    assert f"Stanford diagram, deg: 0 of {posed} poses exceed their level" in page
    assert "Stanford" not in report_html(make_run(3), "bare")
