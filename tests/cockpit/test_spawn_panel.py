"""What the spawn dialog finds and reads, and how a spawn from it is refused or done."""

import base64
import io
import itertools
import json

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from fake_page import FakePage
from PIL import Image
from waiting import until

from drake_twin.cockpit import protocol, spawn_panel
from drake_twin.cockpit.robot_files import robot_files
from drake_twin.cockpit.xacro_trial import XacroTrial
from drake_twin.description.package_index import PackageIndex
from drake_twin.planning import plans
from drake_twin.twin.replay import replay

BODY = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<collision><geometry><box size="0.4 0.4 0.6"/></geometry></collision>'
)

SEEN = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<visual><geometry><box size="1 1 1"/></geometry><material name="m"><color rgba="$(arg color) 0 0.2 1"/></material>'
    "</visual>"
)


def xacro(file, body, name='name="made"'):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f'<robot {name} xmlns:xacro="http://www.ros.org/wiki/xacro">{body}</robot>')
    return file


class Dialog:
    """The dialog of a page without a browser."""

    def __init__(self, twin):
        self.page = FakePage(twin)

    def ask(self, **fields):
        self.page.ask(protocol.AskPanel("spawn", json.dumps(fields)))

    def look(self, file=""):
        self.ask(do="Look", file=file)
        return self.page.state["panels"]["spawn"]

    def spawn(self, file, name="new", **fields):
        given = {
            "xyz": [0, 3, 0],
            "rpy": [0, 0, 0],
            "stands": True,
            "beside": False,
            "arguments": "{}",
            "controllers": "",
        }
        self.ask(do="Spawn", key=name, file=str(file), name=name, **{**given, **fields})

    def outcome(self):
        """The last spawn's, once it has one."""
        return until(lambda: (state := self.look())["status"] != "reading" and state)


@pytest.fixture
def dialog(tmp_path):
    it = Dialog(rovers(1).build())
    yield it
    it.page.cockpit.close()


def test_a_spawn_plans_its_robot_once_and_replays_to_the_same_state(tmp_path, dialog, monkeypatch):
    planned = []
    for module in (spawn_panel, plans):

        def counting(robot, *arguments, original=module.plan_robot, **named):
            planned.append(robot.name)
            return original(robot, *arguments, **named)

        monkeypatch.setattr(module, "plan_robot", counting)
    twin = dialog.page.twin
    twin.recorder.begin()
    dialog.spawn(ROVER)
    assert dialog.outcome()["status"] == "done"
    assert planned == ["new"]
    twin.step(10)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_a_robot_stands_beside_what_is_there(dialog):
    twin = dialog.page.twin
    for name in ("second", "third"):
        dialog.spawn(ROVER, name, xyz=[9, 9, 0], beside=True)
        assert dialog.outcome()["status"] == "done"
    places = [twin.entities.state(robot).position for robot in twin.robots]
    assert places[1] == pytest.approx((0, 1.0, places[0][2]), abs=0.3)
    for one, other in itertools.combinations(places, 2):
        assert np.hypot(one[0] - other[0], one[1] - other[1]) > 0.6
    begin = [twin.robot_state(robot).base_pose[:3] for robot in twin.robots]
    twin.advance_to(0.3)  # none is pushed away by another one
    for robot, pose in zip(twin.robots, begin, strict=True):
        assert twin.robot_state(robot).base_pose[:2] == pytest.approx(pose[:2], abs=0.02)


def test_the_dialog_is_told_how_large_a_robot_is_and_a_free_place(dialog, tmp_path):
    file = xacro(tmp_path / "made.xacro", f'<xacro:arg name="x" default="1"/><link name="a">{BODY}</link>')
    dialog.ask(do="Measure", key="k", file=str(file), arguments="{}")
    box = until(lambda: dialog.look(str(file))["box"])
    assert box["problem"] == ""
    assert (box["key"], box["lower"], box["upper"]) == ("k", [-0.2, -0.2, -0.3], [0.2, 0.2, 0.3])
    assert box["place"][0] == 0.0
    assert 0.6 < box["place"][1] < 1.2  # the rover is at the origin, half as wide as 0.5 m


def test_what_cannot_be_measured_has_no_place_and_the_reason(dialog, tmp_path):
    dialog.ask(do="Measure", key="k", file=str(xacro(tmp_path / "bad.xacro", "<link/>")), arguments="{}")
    box = until(lambda: dialog.look()["box"])
    assert set(box) == {"key", "problem"}
    assert "bad.xacro" in box["problem"]


def test_robot_files_are_those_that_name_a_robot_in_every_package_once(tmp_path):
    package = tmp_path / "src" / "my_robot"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>")
    xacro(package / "urdf" / "arm.urdf.xacro", '<link name="a"/>')
    xacro(package / "urdf" / "macros.xacro", '<xacro:macro name="m"/>', name="")
    (package / "urdf" / "plain.urdf").write_text('<?xml version="1.0"?>\n<robot\n  name="plain"/>')
    (package / "model.sdf").write_text('<sdf version="1.9"><model name="m"/></sdf>')
    (package / "hall.sdf").write_text('<sdf version="1.9"><world name="w"><model name="m"/></world></sdf>')
    (package / "meshes").mkdir()
    (package / "meshes" / "odd.urdf").write_text('<robot name="odd"/>')
    found = list(robot_files(PackageIndex([tmp_path], {})))
    own = [address for address in found if address.startswith("package://my_robot/")]
    assert own == [f"package://my_robot/{name}" for name in ("model.sdf", "urdf/arm.urdf.xacro", "urdf/plain.urdf")]
    assert {ROVER, ARM} <= set(found)
    assert len(set(found)) == len(found)
    for address in found:
        assert PackageIndex([tmp_path], {}).resolve(address).is_file()


def test_the_dialog_lists_robots_and_a_files_arguments_while_it_is_open(dialog, tmp_path):
    assert dialog.page.state["panels"]["spawn"] is None
    file = xacro(tmp_path / "r.xacro", '<xacro:arg name="wheels" default="4"/><xacro:arg name="prefix"/>')
    state = until(lambda: (state := dialog.look(str(file)))["files"] is not None and state)
    assert ROVER in state["files"]
    assert state["here"] == [ROVER]
    assert state["arguments"] == {"wheels": "4", "prefix": ""}
    assert dialog.look("nowhere.xacro")["arguments"] == {}
    seen = [dialog.page.state["panels"]["spawn"] for _ in range(70)]
    assert 50 < sum(state is not None for state in seen) <= 60  # about four seconds
    assert seen[-1] is None


def test_a_robot_is_spawned_with_its_arguments_standing_on_the_ground(dialog, tmp_path):
    file = xacro(tmp_path / "r.xacro", f'<xacro:arg name="link" default="a"/><link name="$(arg link)">{BODY}</link>')
    dialog.spawn(file, arguments='{"link": "other"}', xyz=[1, 3, 0.5], rpy=[0, 0, 0.3])
    assert dialog.outcome()["status"] == "done"
    plan = dialog.page.twin.built.plans[1]
    assert plan.description.root_link == "other"
    assert plan.robot.xyz == (1, 3, pytest.approx(0.5 + 0.3, abs=0.002))  # its box is 0.6 m high
    assert plan.robot.rpy == (0, 0, 0.3)
    dialog.spawn(file, name="low", stands=False, xyz=[1, 6, 0.5])
    assert dialog.outcome()["status"] == "done"
    assert dialog.page.twin.built.plans[2].robot.xyz == (1, 6, 0.5)


def test_what_is_refused_is_said_in_the_dialog_and_changes_nothing(dialog, tmp_path):
    broken = xacro(tmp_path / "broken.xacro", '<link name="${1/0}"/>')
    huge = xacro(tmp_path / "huge.xacro", '<link name="${9**9**9}"/>')
    odd = tmp_path / "odd.yaml"
    odd.write_text("{")
    sha256 = dialog.page.twin.state_sha256()
    for file, fields, what in (
        ("/nowhere.urdf", {}, "the file does not exist"),
        (ROVER, {"name": "robot_1"}, "already exists"),
        (ROVER, {"name": "a b"}, "a b"),
        (ROVER, {"arguments": "[1]"}, "is not a JSON object of texts"),
        (ROVER, {"controllers": str(odd)}, "odd.yaml"),
        (broken, {}, "division by zero"),
        (huge, {}, "too many digits"),
        (odd, {}, "odd.yaml"),
    ):
        dialog.spawn(file, **fields)
        state = dialog.outcome()
        assert (state["status"], what in state["message"]) == ("refused", True), state["message"]
    assert dialog.page.twin.state_sha256() == sha256
    dialog.ask(do="Spawn", file=ROVER)
    assert dialog.page.state
    assert "unknown request" in dialog.page.messages[-1][1]


def test_a_file_that_takes_too_long_is_ended_and_the_twin_goes_on_meanwhile(dialog, tmp_path, monkeypatch):
    loops = '<xacro:macro name="m" params="n"><xacro:if value="${n > 0}">' + 2 * '<xacro:m n="${n - 1}"/>'
    slow = xacro(tmp_path / "slow.xacro", loops + '</xacro:if></xacro:macro><xacro:m n="60"/><link name="a"/>')
    monkeypatch.setattr(spawn_panel, "XacroTrial", lambda *given: XacroTrial(*given, longest=1.0))
    dialog.spawn(slow)
    dialog.look()
    steps = dialog.page.twin.clock.step_count
    dialog.page.twin.advance_to(0.1)
    assert dialog.page.twin.clock.step_count > steps
    assert dialog.page.state["panels"]["spawn"]["status"] == "reading"
    dialog.spawn(ROVER, name="impatient")
    assert "another robot is being spawned" in dialog.page.state["panels"]["spawn"]["message"]
    until(lambda: dialog.look()["status"] == "refused" and "xacro" in dialog.look()["message"])
    assert "xacro takes longer than 1 s to expand the file" in dialog.look()["message"]
    monkeypatch.undo()
    dialog.spawn(ROVER, name="after")
    assert dialog.outcome()["status"] == "done"


def test_a_robot_is_drawn_before_it_is_spawned_and_what_is_wrong_with_it_is_said(dialog, tmp_path):
    file = xacro(tmp_path / "r.xacro", f'<xacro:arg name="color" default="0"/><link name="a">{SEEN}</link>')

    def previewed(key, **fields):
        dialog.ask(do="Preview", key=key, **fields)

        def drawn():
            shown = dialog.look(fields["file"])["preview"]
            return shown if shown is not None and shown["key"] == key else None

        return until(drawn)

    pictures = {}
    for color in ("0", "1"):
        shown = previewed(color, file=str(file), arguments=json.dumps({"color": color}))
        assert shown["problem"] == ""
        pictures[color] = np.array(Image.open(io.BytesIO(base64.b64decode(shown["picture"]))))
    assert pictures["0"].shape == (240, 320, 3)
    middle = {color: picture[100:140, 140:180].reshape(-1, 3).mean(axis=0) for color, picture in pictures.items()}
    assert middle["1"][0] > 2 * middle["0"][0]  # red
    assert (
        previewed("c", file="/nowhere.urdf", arguments="{}")["problem"]
        == "model: /nowhere.urdf: the file does not exist."
    )
    assert "is not a JSON object" in previewed("d", file=str(file), arguments="[]")["problem"]
    assert len(dialog.page.twin.robots) == 1


def test_a_drawing_ends_with_the_dialog(dialog):
    dialog.ask(do="Preview", key="a", file=ROVER, arguments="{}")
    dialog.look(ROVER)
    panel = dialog.page.cockpit.panels["spawn"]
    drawn = panel._drawing[0]
    for _ in range(70):
        assert dialog.page.state
    assert panel._drawing is None
    assert drawn._process.poll() is not None
