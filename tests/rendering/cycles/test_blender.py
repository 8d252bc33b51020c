"""Blender is looked for in a fixed order, and its absence says what to do."""

import stat
import sys
from pathlib import Path

import pytest

from proxnav.errors import InputError
from proxnav.rendering.cycles import blender, environment


@pytest.fixture
def nowhere(tmp_path, monkeypatch) -> Path:
    """A world without any Blender."""
    monkeypatch.delenv("PROXNAV_BLENDER", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("PROXNAV_HOME", str(tmp_path / "home"))
    (tmp_path / "bin").mkdir()
    return tmp_path


def executable(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#!/bin/sh\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def ready_environment(root: Path) -> Path:
    folder = root / "home" / "blender"
    python = executable(blender.environment_python(folder))
    (folder / blender.READY).write_text("4.5\n")
    return python


def test_without_any_the_error_names_the_three_places_and_the_command(nowhere):
    with pytest.raises(InputError, match=r"PROXNAV_BLENDER .* PATH .*home.blender .*proxnav setup blender"):
        blender.find_blender()


def test_an_environment_without_its_mark_is_not_taken(nowhere):
    python = ready_environment(nowhere)
    assert blender.find_blender() == python
    (nowhere / "home" / "blender" / blender.READY).unlink()
    with pytest.raises(InputError):
        blender.find_blender()


def test_the_variable_wins_over_the_path_and_the_path_over_the_environment(nowhere, monkeypatch):
    ready_environment(nowhere)
    on_path = executable(nowhere / "bin" / "blender")
    assert blender.find_blender() == on_path
    named = executable(nowhere / "elsewhere" / "blender-4.5")
    monkeypatch.setenv("PROXNAV_BLENDER", str(named))
    assert blender.find_blender() == named


def test_a_variable_that_names_nothing_is_refused_by_name(nowhere, monkeypatch):
    executable(nowhere / "bin" / "blender")
    monkeypatch.setenv("PROXNAV_BLENDER", "/no/such/blender")
    with pytest.raises(InputError, match="PROXNAV_BLENDER names /no/such/blender"):
        blender.find_blender()


def test_a_python_gets_the_script_and_blender_gets_it_in_the_background():
    assert blender.worker_command(Path("/x/python3.11")) == ["/x/python3.11", "-u", str(blender.WORKER)]
    command = blender.worker_command(Path("/x/blender"))
    assert command[:2] == ["/x/blender", "--background"]
    assert command[-2:] == ["--python", str(blender.WORKER)]


def test_data_home_follows_the_platform(monkeypatch):
    monkeypatch.delenv("PROXNAV_HOME", raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_DATA_HOME", "/data")
    assert blender.environment_folder() == Path("/data/proxnav/blender")
    monkeypatch.delenv("XDG_DATA_HOME")
    assert blender.environment_folder() == Path.home() / ".local" / "share" / "proxnav" / "blender"


def test_set_up_keeps_a_ready_environment(nowhere):
    python, said = ready_environment(nowhere), []
    assert environment.make_environment(said.append) == python
    assert said == [f"Blender is ready in {python.parent.parent}"]


def test_set_up_under_another_python_asks_for_3_11(nowhere, monkeypatch):
    monkeypatch.setattr(sys, "version_info", (3, 13, 0))
    with pytest.raises(InputError, match=r"needs CPython 3\.11, this is 3\.13 and no working python3\.11"):
        environment.make_environment(lambda text: None)


@pytest.mark.slow
def test_a_failed_set_up_leaves_nothing_behind(nowhere, monkeypatch):
    monkeypatch.setattr(environment, "BPY_REQUIREMENT", "./no-such-wheel.whl")
    with pytest.raises(InputError, match=r"could not install \./no-such-wheel\.whl \(exit status 1\)"):
        environment.make_environment(lambda text: None)
    assert list((nowhere / "home").iterdir()) == []
