"""What a waiting user is told."""

import pytest

from proxnav.cli import progress


def test_the_first_use_of_a_room_is_announced_and_later_ones_are_not(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr(progress, "__file__", str(tmp_path / "proxnav" / "cli" / "progress.py"))
    cache = tmp_path / "proxnav" / "pose" / "kernels" / "__pycache__"
    cache.mkdir(parents=True)
    progress.say_when_compiling("pose")
    assert "compiling the kernels of pose" in capsys.readouterr().err
    (cache / "p3p.solve-1.py311.nbi").write_bytes(b"")
    progress.say_when_compiling("pose")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("total", [1, 3])
def test_plain_progress_ends_with_a_line(total: int, capsys) -> None:
    with progress.progress("job", total) as done:
        for _ in range(total):
            done()
    assert f"job: {total}/{total}" in capsys.readouterr().err


def test_the_time_left_follows_from_the_items_since_the_last_line_as_first_ones_may_have_compiled(monkeypatch, capsys):
    clock = iter([0.0, 5.0, 70.0, 71.0, 110.0, 114.0])
    monkeypatch.setattr("time.monotonic", lambda: next(clock))
    with progress.progress("job", 5) as done:
        for _ in range(5):
            done()
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["job: 2/5, after 70 s", "job: 4/5, 0.05/s, 20 s left", "job: 5/5, in 114 s"]
