"""When pictures are taken and published, and that each byte is the same in every run."""

import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from camera_rig import ball, camera, need_mesa, twin_with

from drake_twin import Twin
from drake_twin.messages import type_store
from drake_twin.scenario import Robot
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.sensors.cameras.renderer import Renderer
from drake_twin.twin.snapshot import Snapshot

WORLD = "<include><uri>model://sun</uri></include>" + ball([1.5, 0.2, 0.9], 0.2)
NOISE = "<noise><type>gaussian</type><stddev>0.02</stddev></noise>"
CAMERAS = (
    camera("rgbd_camera", (32, 24), rate=20, name="a", topic="a", more=NOISE),
    camera(size=(24, 24), rate=30, name="b", topic="b/image", more=NOISE + "<distortion><k1>-0.2</k1></distortion>"),
)
TOPICS = ("/box/a/image", "/box/a/depth_image", "/box/a/points", "/box/b/image", "/box/b/camera_info")
END = 0.26

_SLOW = """
import sys, time
from drake_twin.sensors.cameras import render_process as process
draw = process.Painter.draw
def slowly(*arguments):
    time.sleep(0.05)
    return draw(*arguments)
process.Painter.draw = slowly
process.main(*sys.argv[1:])
"""


@pytest.fixture(autouse=True)
def mesa():
    need_mesa()


def moving_twin(folder, *cameras, **options):
    """A twin of a box that drifts and turns, so that each picture is another one."""
    twin = twin_with(folder, *(cameras or CAMERAS), world=WORLD, **options)
    twin.entities.set_state("box", linear=[0.2, 0, 0.5], angular=[0, 0, 1.0])
    return twin


def listen(twin, topics=TOPICS):
    """The bytes of each message by topic and stamp."""
    heard = {}
    for topic in topics:
        kind = twin.graph.topics()[topic]

        def take(message, topic=topic, kind=kind):
            stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
            data = bytes(type_store().serialize_cdr(message, kind))
            assert heard.setdefault((topic, stamp), data) == data

        twin.subscribe(topic, take)
    return heard


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    need_mesa()
    with moving_twin(tmp_path_factory.mktemp("first")) as twin:
        heard = listen(twin)
        twin.advance_to(END)
        return heard, twin.state_sha256()


def test_a_picture_is_of_a_multiple_of_the_period_and_a_period_late(tmp_path, first):
    stamps = {topic: sorted(stamp for name, stamp in first[0] if name == topic) for topic in TOPICS}
    assert stamps["/box/a/image"] == [0, 50_000_000, 100_000_000, 150_000_000, 200_000_000]
    assert stamps["/box/a/depth_image"] == stamps["/box/a/points"] == stamps["/box/a/image"]
    assert stamps["/box/b/image"] == stamps["/box/b/camera_info"]
    assert [stamp // 10**6 for stamp in stamps["/box/b/image"]] == [0, 34, 67, 100, 134, 167, 200]
    delays = {"0": 0.0, "0.013": 0.013, "0.12": 0.12}
    for text, delay in delays.items():
        own = camera(size=(8, 8), rate=20, topic="c/image", more=f"<delay>{text}</delay>")
        with moving_twin(tmp_path, own) as twin:
            times = []
            twin.subscribe("/box/c/image", lambda message, twin=twin, times=times: times.append((twin.time, message)))
            twin.advance_to(0.2005)
        late = [time - item.header.stamp.nanosec * 1e-9 for time, item in times]
        assert late == pytest.approx([delay] * len(late), abs=1e-9)
        assert len(late) == {"0": 5, "0.013": 4, "0.12": 2}[text]


def test_nobody_listens_nothing_is_drawn(tmp_path, first):
    with moving_twin(tmp_path) as twin:
        infos = []
        twin.subscribe("/box/b/camera_info", infos.append)
        twin.advance_to(END)
        assert len(infos) == 7
        assert twin._session.built.renderer.asked == 0
        assert twin._session.built.renderer._renderer is None
        assert twin.state_sha256() == first[1]


_QUIET = """
import sys
sys.path[:0] = sys.argv[1:3]
from pathlib import Path
from camera_rig import camera, twin_with
with twin_with(Path(sys.argv[3]), camera()) as twin:
    twin.advance_to(0.1)
    print(*sys.modules)
"""


def test_nobody_listens_nothing_that_draws_is_imported(tmp_path):
    tests = Path(__file__).parent
    words = [sys.executable, "-c", _QUIET, str(tests), str(tests.parent), str(tmp_path)]
    known = subprocess.run(words, capture_output=True, check=True, text=True).stdout.split()
    assert "drake_twin.sensors.camera" in known
    assert not {f"drake_twin.sensors.cameras.{name}" for name in ("renderer", "scene", "render_process")} & {*known}


def test_with_cenic_a_listener_changes_no_state(tmp_path):
    hashes = set()
    for listens in (False, True):
        with moving_twin(tmp_path, engine="cenic", time_step=0.01) as twin:
            heard = listen(twin) if listens else {}
            twin.advance_to(0.2)
            hashes.add(twin.state_sha256())
        assert bool(heard) == listens
    assert len(hashes) == 1


def test_a_robot_that_joins_is_seen_until_it_leaves(tmp_path):
    """And a snapshot from before or after shows what was there then."""
    from camera_rig import on_box
    from rig import BODY

    body = BODY.replace("<collision>", '<visual><geometry><box size=".4 .4 .2"/></geometry></visual><collision>', 1)
    text = camera(size=(32, 24), pose="-2 0 0.5 0 0.1 0")
    with twin_with(tmp_path, text, world="", body=body) as twin:
        other = tmp_path / "other.urdf"
        other.write_text(body.format(on_box("imu")).replace('"box"', '"other"'))
        reading = twin.sensor("box", "s")
        alone = reading.image.tobytes()
        twin.entities.spawn(Robot("other", str(other), xyz=(0, 0.5, 0.1)))
        both = reading.image.tobytes()
        state = twin.snapshot()
        twin.entities.delete("other")
        assert alone == reading.image.tobytes()
        twin.restore(state)
        assert both == reading.image.tobytes()
        assert both != alone
        assert len({*reading.label.ravel().tolist()}) == 4  # the sky, the ground, two robots


def test_topics_of_one_instant_share_its_pictures(tmp_path):
    with moving_twin(tmp_path) as twin:
        for topic in TOPICS[:3]:
            twin.subscribe(topic, lambda message: None)
        twin.advance_to(0.12)
        assert twin._session.built.renderer.asked == 3 * 2


def test_another_order_pauses_and_late_listeners_change_no_byte(tmp_path, first):
    with moving_twin(tmp_path) as twin:
        heard = listen(twin, TOPICS[:0:-1])
        for time in (0.05, 0.0731):
            twin.advance_to(time)
        heard |= (late := listen(twin, TOPICS[:1]))
        twin.advance_to(END)
        assert (heard | late).items() <= first[0].items()
        assert min(stamp for _, stamp in late) == 100_000_000
        assert len(heard) + len(late) == len(first[0]) - 2
        assert twin.state_sha256() == first[1]


def test_a_slow_process_changes_no_byte(tmp_path, monkeypatch, first):
    monkeypatch.setattr(Renderer, "command", (sys.executable, "-c", _SLOW))
    with moving_twin(tmp_path) as twin:
        heard = listen(twin)
        twin.advance_to(END)
        assert (heard, twin.state_sha256()) == first


def test_a_reset_repeats(tmp_path, first):
    with moving_twin(tmp_path) as twin:
        listen(twin)
        twin.advance_to(0.13)
        twin.reset()
        twin.entities.set_state("box", linear=[0.2, 0, 0.5], angular=[0, 0, 1.0])
        heard = listen(twin)
        twin.advance_to(END)
        assert heard == first[0]


def test_a_reset_drops_pictures_that_are_late_and_so_does_the_end_of_a_subscription(tmp_path):
    with moving_twin(tmp_path, camera(size=(8, 8))) as twin:
        images = []
        end = twin.subscribe("/box/cam/image", images.append)
        twin.advance_to(0.05)
        twin.reset()
        twin.advance_to(0.15)
        assert [item.header.stamp.nanosec for item in images] == [0]
        end()
        twin.advance_to(0.25)
        assert len(images) == 1


def test_a_spawn_in_between_keeps_what_is_asked_for(tmp_path, first):
    """The picture before the spawn is the same, though it is published after it."""
    with moving_twin(tmp_path) as twin:
        heard = listen(twin)
        twin.advance_to(0.12)
        twin.entities.spawn(Robot("other", str(tmp_path / "box.urdf"), xyz=(-30, 0, 0.1)))
        twin.advance_to(0.14)
        twin.entities.delete("other")
        twin.advance_to(END)
        before = {key: data for key, data in heard.items() if key[1] <= 100_000_000}
        assert len(before) > 10
        assert before.items() <= first[0].items()
        assert set(heard) == set(first[0])


_OTHER = """
import pickle, sys
sys.path[:0] = sys.argv[1:3]
from pathlib import Path
import test_camera_time as test
sys.stdout.buffer.write(pickle.dumps(getattr(test, sys.argv[3])(Path(sys.argv[4]))))
"""


def in_another_process(what, folder, **environment):
    import os

    tests = Path(__file__).parent
    found = subprocess.run(
        [sys.executable, "-c", _OTHER, str(tests), str(tests.parent), what, str(folder)],
        capture_output=True,
        check=True,
        env={**os.environ, **environment},
    )
    return pickle.loads(found.stdout)


def whole_run(folder):
    with moving_twin(folder) as twin:
        heard = listen(twin)
        twin.advance_to(END)
        return heard, twin.state_sha256()


def restored_run(folder):
    saved = Snapshot.load(folder / "state.json")
    with Twin(ScenarioFile(saved.scenario, "saved").scenario) as twin:
        twin.restore(saved)
        heard = listen(twin)
        twin.advance_to(END)
        return heard, twin.state_sha256()


def test_another_process_with_other_threads_gives_the_same_bytes(tmp_path, first):
    assert in_another_process("whole_run", tmp_path, LP_NUM_THREADS="1") == first


def test_a_snapshot_restored_in_another_process_gives_the_same_bytes(tmp_path, first):
    with moving_twin(tmp_path) as twin:
        listen(twin)
        twin.advance_to(0.117)
        twin.snapshot().save(tmp_path / "state.json")
    heard, state = in_another_process("restored_run", tmp_path)
    assert len(heard) > 10
    assert heard.items() <= first[0].items()
    assert state == first[1]
