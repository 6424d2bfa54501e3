"""Cameras without Mesa, without their process, and over many spawns."""

import logging
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from camera_rig import ball, camera, need_mesa, twin_with

from drake_twin.findings import Kind
from drake_twin.scenario import Robot
from drake_twin.sensors.cameras.renderer import Renderer

MESA = "apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"


def run(tmp_path, listens=True, until=0.25):
    """The twin's state and findings after a run with a listener."""
    with twin_with(tmp_path, camera(size=(16, 12)), world=ball([2, 0, 1], 0.3)) as twin:
        images = []
        if listens:
            twin.subscribe("/box/cam/image", images.append)
        twin.advance_to(until)
        failed = [item.what for item in twin.findings if item.kind is Kind.FAILED]
        return twin.state_sha256(), failed, images


def children():
    """The processes that this one has started and that draw, or have ended without being waited for."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state, parent = (folder / "stat").read_text().rpartition(")")[2].split()[:2]
            command = (folder / "cmdline").read_bytes()
        except OSError:  # it has just ended
            continue
        if int(parent) == os.getpid() and (state == "Z" or b"render_process" in command):
            found.append((folder.name, state, command))
    return found


# The process that draws: as with libEGL and no driver, where VTK ends it, and as without libEGL.
_CRASH = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
_NO_EGL = """
import sys
from drake_twin.sensors.cameras import render_process as process
def none(parameters):
    raise RuntimeError("libEGL.so.1 could not be loaded")
process.MakeRenderEngineVtk = none
process.main(*sys.argv[1:])
"""


@pytest.mark.parametrize(
    ("program", "reason"), [(_CRASH, "was ended by SIGSEGV"), (_NO_EGL, "libEGL.so.1 could not be loaded")]
)
def test_without_opengl_cameras_stop_with_one_message(tmp_path, monkeypatch, caplog, program, reason):
    still, *_ = run(tmp_path, listens=False)
    monkeypatch.setattr(Renderer, "command", (sys.executable, "-c", program))
    with caplog.at_level(logging.WARNING):
        state, failed, images = run(tmp_path)
    assert state == still
    assert images == []
    assert len(failed) == 1
    assert MESA in failed[0]
    assert reason in failed[0]
    assert [record.getMessage() for record in caplog.records] == failed
    assert children() == []


def test_libegl_without_a_driver(tmp_path, monkeypatch):
    need_mesa()
    still, *_ = run(tmp_path, listens=False)
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent")
    state, failed, images = run(tmp_path)
    assert (state, len(failed), images) == (still, 1, [])
    assert MESA in failed[0]


def test_a_process_that_is_killed_while_it_draws(tmp_path):
    need_mesa()
    still, *_ = run(tmp_path, listens=False)
    for attempt in range(10):
        with twin_with(tmp_path, camera(size=(16, 12)), world=ball([2, 0, 1], 0.3)) as twin:
            images = []
            twin.subscribe("/box/cam/image", images.append)
            asked = 2 if attempt % 5 == 0 else 1
            twin.advance_to(0.1 * (asked - 1) + 0.001)
            renderer = twin._session.built.renderer.get()
            os.kill(renderer.process.pid, signal.SIGKILL)
            twin.advance_to(0.25)
            failed = [item.what for item in twin.findings if item.kind is Kind.FAILED]
            assert len(failed) == 1
            assert "was ended by SIGKILL" in failed[0]
            assert (MESA in failed[0]) == (not images)
            assert twin.state_sha256() == still
            assert twin.latest("/box/cam/image") is None
            assert twin.sensor("box", "s").image is None
            assert len(images) <= asked
    assert children() == []


@pytest.mark.parametrize("kind", ["camera", "depth_camera"])
def test_a_camera_that_cannot_be_drawn_stops_alone_and_with_its_own_reason(tmp_path, caplog, kind):
    """Nearer than the renderer's least distance there is nothing to draw."""
    need_mesa()
    bad = camera(kind, size=(16, 12), clip="<near>1e-9</near><far>1e-8</far>", name="bad", topic="bad/image")
    good = camera(kind, size=(16, 12), name="good", topic="good/image")
    with twin_with(tmp_path, bad, good, world=ball([2, 0, 1], 0.3)) as twin, caplog.at_level(logging.WARNING):
        images, others = [], []
        twin.subscribe("/box/bad/image", images.append)
        twin.subscribe("/box/good/image", others.append)
        twin.advance_to(0.35)
        assert (len(images), len(others)) == (0, 3)
        (failed,) = [item.what for item in twin.findings if item.kind is Kind.FAILED]
        twin.entities.spawn(Robot("other", str(tmp_path / "box.urdf"), xyz=(-3, 0, 0.1)))
        twin.advance_to(0.55)
        assert (len(images), len(others)) == (0, 5)
    assert failed.startswith("camera box/box/bad has stopped: The clipping range")
    assert "Mesa" not in failed
    assert [record.getMessage() for record in caplog.records] == [failed]


def test_the_process_ends_with_its_twin_and_with_its_parent(tmp_path):
    need_mesa()
    with twin_with(tmp_path, camera(size=(16, 12)), world="") as twin:
        assert twin.sensor("box", "s").image.shape == (12, 16, 3)
        assert len(children()) == 1
    assert children() == []
    program = (
        "import os, sys; sys.path[:0] = sys.argv[1:3]; import pathlib; from camera_rig import *\n"
        "twin = twin_with(pathlib.Path(sys.argv[3]), camera(size=(16, 12)), world='')\n"
        "assert twin.sensor('box', 's').image is not None\n"
        "print(twin._session.built.renderer.get().process.pid, flush=True)\n"
        "os.kill(os.getpid(), 9)\n"
    )
    here = os.path.dirname(__file__)
    arguments = [sys.executable, "-c", program, here, os.path.dirname(here), str(tmp_path)]
    said = subprocess.run(arguments, capture_output=True, check=False)
    pid = int(said.stdout)
    pidfd = None
    try:
        pidfd = os.pidfd_open(pid)
    except ProcessLookupError:
        return
    import select

    assert select.select([pidfd], [], [], 30)[0], "the process outlives its parent"


def memory(pid):
    with open(f"/proc/{pid}/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def spawn_and_delete(tmp_path, times, listens):
    """How much the memory of a twin and of the process that draws grows (MiB)."""
    with twin_with(tmp_path, camera(size=(16, 12), rate=100), world=ball([2, 0, 1], 0.3)) as twin:
        images, sizes, pids = [], [], {os.getpid()}
        if listens:
            twin.subscribe("/box/cam/image", images.append)
        twin.advance_to(0.05)
        for number in range(times):
            twin.entities.spawn(Robot("other", str(tmp_path / "box.urdf"), xyz=(-3, 0, 0.1)))
            twin.advance_to(twin.time + 0.02)
            twin.entities.delete("other")
            twin.advance_to(twin.time + 0.02)
            if listens:
                pids.add(twin._session.built.renderer.get().process.pid)
            if number >= times // 4:
                sizes.append({pid: memory(pid) for pid in pids})
        assert len(pids) == 1 + listens
        assert listens == ("drake_twin_pictures" in Path("/proc/self/maps").read_text(encoding="ascii"))
        assert len(images) == (pytest.approx(times * 4 + 4, abs=2) if listens else 0)
        return [sizes[-1][pid] - sizes[0][pid] for pid in sorted(pids, key=lambda pid: pid != os.getpid())]


@pytest.mark.parametrize("times", [20, pytest.param(200, marks=pytest.mark.slow)])
def test_memory_stays_flat_over_spawns_and_deletes(tmp_path, times):
    need_mesa()
    (still,) = spawn_and_delete(tmp_path, times, listens=False)
    files = len(os.listdir("/proc/self/fd"))
    twin, process = spawn_and_delete(tmp_path, times, listens=True)
    assert still < 2.0
    assert twin < 4.0
    assert process < 8.0
    assert len(os.listdir("/proc/self/fd")) <= files
    assert "drake_twin_pictures" not in Path("/proc/self/maps").read_text(encoding="ascii")
    assert children() == []


@pytest.mark.slow
def test_8k_at_60_hz_is_drawn_and_leaves_the_state_as_it_is(tmp_path):
    need_mesa()
    still, *_ = run(tmp_path, listens=False, until=0.05)
    with twin_with(tmp_path, camera(size=(7680, 4320), rate=60), world=ball([2, 0, 1], 0.3)) as twin:
        images = []
        twin.subscribe("/box/cam/image", images.append)
        twin.advance_to(0.05)
        assert [len(image.data) for image in images] == [7680 * 4320 * 3] * 2
        assert twin.state_sha256() == still
    assert children() == []


def test_8k_at_60_hz_is_said_and_runs(tmp_path):
    with twin_with(tmp_path, camera(size=(7680, 4320), rate=60), world="") as twin:
        said = [text for text in twin.findings.warnings if "7680 × 4320" in text]
        twin.advance_to(0.05)
    assert len(said) == 1
