"""The Blender worker is replaced when it dies, hangs or grows, and says why when it cannot start."""

import os
import signal
import sys
import threading
import time
from pathlib import Path

import pytest
import trimesh

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.rendering.cycles import CyclesConfig
from proxnav.rendering.cycles.blender import find_blender
from proxnav.rendering.cycles.process import BlenderWorker, WorkerDied
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.targets import Material

T_FACING = Pose.from_wxyz("cam", "target", [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 15.0])


@pytest.fixture
def ball(make_target):
    return make_target([trimesh.creation.icosphere(subdivisions=2, radius=2.0)], [Material()])


@pytest.fixture
def scene(make_scene):
    return make_scene(Camera(96, 96, 300.0, 300.0, 48.0, 48.0), T_FACING)


@pytest.mark.blender
@pytest.mark.usefixtures("blender")
def test_a_worker_killed_during_a_frame_is_replaced_and_the_frame_is_the_same(ball, scene):
    with CyclesRenderer(ball, CyclesConfig(samples=400)) as renderer:
        expected = renderer.render(scene)
        first = renderer._worker
        assert first is not None
        killer = threading.Timer(0.1, lambda: os.kill(first.process.pid, signal.SIGKILL))
        killer.start()
        frame = renderer.render(scene)
        killer.join()
        if renderer._worker is first:  # the frame was faster than the killer
            frame = renderer.render(scene)
        assert renderer._worker is not first
    assert frame.radiance.tobytes() == expected.radiance.tobytes()
    assert frame.depth_m.tobytes() == expected.depth_m.tobytes()


@pytest.mark.blender
@pytest.mark.usefixtures("blender")
def test_a_worker_over_its_memory_limit_is_replaced_between_frames(ball, scene):
    with CyclesRenderer(ball, CyclesConfig(samples=4, memory_limit_mb=1.0)) as renderer:
        first = renderer.render(scene)
        assert renderer._worker is None
        second = renderer.render(scene)
    assert first.radiance.tobytes() == second.radiance.tobytes()


@pytest.mark.blender
@pytest.mark.usefixtures("blender")
def test_a_worker_that_has_drawn_its_frames_is_replaced(ball, scene):
    with CyclesRenderer(ball, CyclesConfig(samples=4, frames_per_worker=2)) as renderer:
        first = renderer.render(scene)
        worker = renderer._worker
        assert worker is not None
        renderer.render(scene)
        assert renderer._worker is None
        third = renderer.render(scene)
        assert renderer._worker not in (None, worker)
    assert first.radiance.tobytes() == third.radiance.tobytes()


@pytest.mark.blender
@pytest.mark.usefixtures("blender")
def test_a_worker_that_hangs_is_given_up_with_its_last_words(ball, scene):
    config = CyclesConfig(samples=2_000_000, timeout_s=1.0, attempts=1)
    with CyclesRenderer(ball, config) as renderer, pytest.raises(RuntimeError, match=r"no answer in 1 s[^$]*Sample"):
        renderer.render(scene)


@pytest.mark.blender
@pytest.mark.usefixtures("blender")
def test_closing_leaves_no_process_and_no_file(ball, scene):
    with CyclesRenderer(ball, CyclesConfig(samples=4)) as renderer:
        renderer.render(scene)
        worker = renderer._worker
        assert worker is not None
        assert Path(worker.folder.name).is_dir()
    assert worker.process.poll() is not None
    assert not Path(worker.folder.name).exists()


def test_a_python_without_bpy_is_named(ball, scene, monkeypatch):
    monkeypatch.setenv("PROXNAV_BLENDER", sys.executable)
    with pytest.raises(InputError, match=r"does not run Blender's Python \(ModuleNotFoundError: No module named 'bpy'"):
        CyclesRenderer(ball).render(scene)


def test_what_a_worker_printed_is_in_the_error():
    command = [sys.executable, "-c", "import sys; sys.exit('no such luck')"]
    with pytest.raises(WorkerDied, match=r"exit status 1; it last printed:\nno such luck"):
        BlenderWorker.start(command, 20.0)


def test_a_silent_worker_is_killed_after_its_time():
    began = time.monotonic()
    with pytest.raises(WorkerDied, match=r"gave no answer in 0\.5 s"):
        BlenderWorker.start([sys.executable, "-c", "import time; time.sleep(60)"], 0.5)
    assert time.monotonic() - began < 20.0


@pytest.mark.blender
@pytest.mark.usefixtures("blender")
def test_a_blender_executable_that_greets_first_serves_as_well(ball, scene, tmp_path, monkeypatch):
    python = find_blender()
    if "python" not in python.name:
        pytest.skip("a Blender executable is what the other tests run under")
    with CyclesRenderer(ball, CyclesConfig(samples=4)) as renderer:
        expected = renderer.render(scene)
    greeting = 'echo "Blender 4.5.0"; for script; do :; done'  # the script is the last argument
    executable = tmp_path / "blender"
    executable.write_text(f'#!/bin/sh\n{greeting}; exec "{python}" "$script"\n')
    executable.chmod(0o755)
    monkeypatch.setenv("PROXNAV_BLENDER", str(executable))
    with CyclesRenderer(ball, CyclesConfig(samples=4)) as renderer:
        assert renderer.render(scene).radiance.tobytes() == expected.radiance.tobytes()
