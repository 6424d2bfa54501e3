"""One slip in one file: the twin is the same, or a finding tells of it, or it is refused with its line.

`spoiling` makes the slips, `fingerprint` tells whether the twin is the same: neither knows the findings.
"""

import logging
import re
import shutil
from random import Random

import pytest
from mutations import LAUNCH, MJCF, OBJ, ROBOT, SDF, stl
from spoiled import EQUAL, FAULT, FOUND, REFUSED, SILENT, Spoiled
from spoiling import sample, slips

from drake_twin.description.package_index import share_folder

ROVER_FILES = ["rover_description/urdf/rover.urdf.xacro", "rover_description/urdf/wheel.xacro"]
ROVER_FILES += ["rover_description/urdf/rover.ros2_control.xacro", "rover_description/urdf/rover.gazebo.xacro"]
ARM = "arduinobot_description"

# What is run, and the files of it in which slips are made.
TARGETS = {
    "launch.xml": (["rover_gazebo/launch/main.launch.xml"], ["rover_gazebo/launch/spawn_with_control.launch.xml"]),
    "launch.py": (
        ["rover_gazebo/launch/main.launch.xml"],
        ["rover_gazebo/launch/start_world.launch.py", "rover_gazebo/launch/start_control.launch.py"],
    ),
    "controllers": (
        ["rover_gazebo/launch/main.launch.xml"],
        ["rover_description/config/rover_drive.yaml", "rover_description/config/rover_controllers.yaml"],
    ),
    "rover": (["rover_description/urdf/rover.urdf.xacro", "robot_name:=rover"], ROVER_FILES),
    "arm": (
        [f"{ARM}/urdf/arduinobot.urdf.xacro"],
        [f"{ARM}/config/arduinobot_controllers.yaml", f"{ARM}/urdf/arm_links.xacro"],
    ),
    "world": (["diagrams/rovers_among_crates.yaml"], ["diagrams/crates.sdf", "diagrams/rovers_among_crates.yaml"]),
    "world of a launch file": (["rover_gazebo/launch/main.launch.xml"], ["rover_gazebo/worlds/plain.sdf"]),
    "classic": (["classic/robot.urdf.xacro"], ["classic/robot.urdf.xacro"]),
    "sdf": (["classic/robot.sdf"], ["classic/robot.sdf"]),
    "mjcf": (["classic/robot.xml"], ["classic/robot.xml"]),
    "launch.yaml": (["diagrams/driven_rover.launch.yaml"], ["diagrams/driven_rover.launch.yaml"]),
}


def lines(xml):
    """XML with a line for each element, so that a line tells which one it is."""
    return re.sub(r">\s*<", ">\n<", xml)


@pytest.fixture(autouse=True)
def _quiet():
    logging.disable(logging.CRITICAL)
    yield
    logging.disable(logging.NOTSET)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("spoiled")
    shutil.copytree(share_folder("models"), folder, dirs_exist_ok=True)
    shutil.copytree(share_folder("diagrams"), folder / "diagrams")
    (folder / "classic").mkdir()
    texts = {"robot.urdf.xacro": ROBOT, "robot.sdf": SDF, "robot.xml": MJCF, "main.launch.xml": LAUNCH}
    for name, text in texts.items():
        mesh = "tip.obj" if name.endswith("sdf") else "tip.stl"
        (folder / "classic" / name).write_text(lines(text.replace("MESH", mesh)), encoding="utf-8")
    (folder / "classic" / "tip.stl").write_bytes(stl())
    (folder / "classic" / "tip.obj").write_text(OBJ)
    return folder


def lost(folder, name, count):
    """The slips of a target that change the robot and are not told, or that end in anything but a paragraph."""
    entry, files = TARGETS[name]
    target, found, outcomes = Spoiled(folder, entry), [], set()
    for file in files:
        random = Random(file)
        text = (folder / file).read_text(encoding="utf-8")
        for slip in sample(slips(text, file, random), count, random):
            outcome, how = target.outcome(folder / file, slip)
            outcomes.add(outcome)
            if outcome in (SILENT, FAULT):
                found.append(f"{outcome}: {slip.kind} in {file}:{slip.line}: {slip.what}: {how}")
    assert outcomes <= {EQUAL, FOUND, REFUSED, SILENT, FAULT}
    return found


@pytest.mark.parametrize("name", TARGETS)
def test_a_slip_that_changes_the_robot_is_told(folder, name):
    assert lost(folder, name, 8) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_every_kind_of_slip_at_many_places_is_told(folder, name):
    assert lost(folder, name, 80) == []


def test_a_change_of_the_robot_is_seen_without_findings(folder, tmp_path):
    """The reference: each of these changes the fingerprint, and is none that a finding could tell of."""
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    target = Spoiled(tmp_path, ["classic/robot.sdf"])
    file = tmp_path / "classic" / "robot.sdf"
    text = file.read_text()
    for old, new in (
        ("<mass>2", "<mass>3"),
        ("<ixx>0.1", "<ixx>0.11"),
        ("<size>0.2", "<size>0.21"),
        ("<mu>0.5", "<mu>0.6"),
        ("<upper>1", "<upper>2"),
        ("<xyz>0 1 0", "<xyz>1 0 0"),
        ("<pose>0 0 0.3", "<pose>0 0.1 0.3"),
        ("<update_rate>10", "<update_rate>20"),
        ('name="imu" type="imu"', 'name="gyro" type="imu"'),
    ):
        assert old in text
        file.write_text(text.replace(old, new))
        from fingerprint import difference

        prints, _ = target._load()
        assert list(difference(target._before, prints)), old
    file.write_text(text)
    assert list(difference(target._before, target._load()[0])) == []
