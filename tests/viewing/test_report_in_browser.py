"""The report in a real browser: it renders without a complaint, sorts, filters and enlarges."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from proxnav.viewing.report import report_html

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    "--headless --no-sandbox --disable-gpu --disable-background-networking --disable-component-update --disable-sync "
    "--disable-default-apps --disable-extensions --disable-dev-shm-usage --no-first-run --virtual-time-budget=5000 "
    "--enable-logging=stderr --dump-dom"
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH (apt-get install chromium)"),
]


def _dom(page: str, folder: Path, act: str = "") -> str:
    """The document after the script `act`; fails on anything that the browser logs from the page."""
    if act:  # the page forbids foreign scripts: the policy goes before one is added
        page = re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page)
        page = page.replace("</body>", f"<script>{act}</script></body>")
    file = folder / "report.html"
    file.write_text(page, encoding="utf-8")
    command = [str(CHROMIUM), *FLAGS.split(), f"--user-data-dir={folder / 'profile'}", file.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    assert "CONSOLE" not in done.stderr, done.stderr
    return done.stdout


def _shown(dom: str) -> list[list[str]]:
    body = dom.split('id="frame-table"')[1].split("<tbody>")[1].split("</tbody>")[0]
    rows = re.findall(r"<tr([^>]*)>(.*?)</tr>", body, re.DOTALL)
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", cells) for attributes, cells in rows if "hidden" not in attributes]


def test_it_renders_with_its_own_policy_and_logs_nothing(make_run, tmp_path: Path) -> None:
    evil = "<img src=x onerror=console.error(1)>.png"
    folder = make_run(6, names=[evil, *(f"{k}.png" for k in range(5))])
    assert len(_shown(_dom(report_html(folder, "run"), tmp_path))) == 6


def test_a_foreign_script_is_refused_by_the_policy(make_run, tmp_path: Path) -> None:
    page = report_html(make_run(6), "run").replace("</body>", "<script>document.title = 'taken'</script></body>")
    with pytest.raises(AssertionError, match="Content Security Policy"):
        _dom(page, tmp_path)


def test_a_heading_sorts_up_then_down_and_frames_without_a_pose_stay_last(make_run, tmp_path: Path) -> None:
    page = report_html(make_run(12), "run")
    click = "document.querySelectorAll('#frame-table thead button')[8].click();"
    for act, order in ((click, 1), (click * 2, -1)):
        dom = _dom(page, tmp_path, act)
        rows = _shown(dom)
        assert rows[-1][1] == "no_consensus"
        turns = [float(row[8]) for row in rows[:-1]]
        assert turns == sorted(turns, reverse=order < 0)
        assert f'aria-sort="{"ascending" if order > 0 else "descending"}"' in dom


def test_filters_hide_frames_and_count_what_is_left(make_run, tmp_path: Path) -> None:
    page = report_html(make_run(12), "run")
    act = (
        "const status = document.getElementById('filter-status'); status.value = 'no_consensus';"
        "status.dispatchEvent(new Event('input', {bubbles: true}));"
    )
    dom = _dom(page, tmp_path, act)
    assert [row[0] for row in _shown(dom)] == ["000001.png"]
    assert "1 of 12 frames" in dom


def test_an_overlay_opens_large_and_the_arrow_key_goes_on(make_run, tmp_path: Path) -> None:
    page = report_html(make_run(6), "run")
    act = (
        "document.querySelector('.thumb').click(); const large = document.getElementById('large');"
        "large.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'}));"
    )
    dom = _dom(page, tmp_path, act)
    dialog = dom.split("<dialog")[1]
    assert " open" in dialog.split(">")[0]
    assert 'alt="Overlay of frame 2 of 6' in dialog
