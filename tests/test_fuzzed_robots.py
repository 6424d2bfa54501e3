"""Broken robot files never end in anything but a robot that runs or one readable error.

Good URDFs are mutated, and a twin is built of each and advanced a little. Drake can end the process or never return, so
this happens in a worker process that is started again when it dies or hangs. 500 mutations are tried by default; the
environment variable DRAKE_TWIN_FUZZ_EXAMPLES asks for another number, and the test marked slow tries 3000.
"""

import multiprocessing
import os
import re
import traceback
from collections.abc import Iterator
from copy import deepcopy
from math import isfinite
from pathlib import Path

import pytest
import trimesh
from conftest import ARM, ROVER
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from drake_twin import TwinBuilder
from drake_twin.description.drake_urdf import DRAKE_RULES
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.repairs import REPAIRS
from drake_twin.description.xacro_file import expand_xacro
from drake_twin.errors import InputError, RunError, TwinError

REPAIRS = [*REPAIRS, *DRAKE_RULES]
LONGEST = 10.0  # s of wall time that a mutated robot may take

# Every kind of element that the twin reads, once.
EVERYTHING = """<robot name="all">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="world"/>
  <link name="base">
    <inertial><origin xyz="0 0 0.1" rpy="0 0 0"/><mass value="2"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>
    <visual name="v"><origin xyz="0 0 0.1"/><geometry><box size="0.2 0.2 0.2"/></geometry>
      <material name="red"/></visual>
    <collision><origin xyz="0 0 0.1" rpy="0 0 0.1"/><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
  </link>
  <link name="arm">
    <inertial><mass value="0.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <visual><geometry><cylinder radius="0.05" length="0.3"/></geometry><material name="blue"><color rgba="0 0 1 1"/>
      </material></visual>
    <collision><geometry><cylinder radius="0.05" length="0.3"/></geometry></collision>
  </link>
  <link name="slide">
    <inertial><mass value="0.2"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <link name="finger">
    <inertial><mass value="0.1"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
    <visual><geometry><mesh filename="tip.stl" scale="0.1 0.1 0.1"/></geometry></visual>
    <collision><geometry><mesh filename="tip.stl" scale="0.1 0.1 0.1"/></geometry></collision>
    <collision><geometry><capsule radius="0.02" length="0.1"/></geometry></collision>
  </link>
  <link name="plate">
    <inertial><mass value="0.3"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
  </link>
  <link name="tool"/>
  <joint name="foot" type="fixed"><parent link="world"/><child link="base"/><origin xyz="0 0 0.2"/></joint>
  <joint name="elbow" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.3" rpy="0 0.1 0"/>
    <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" effort="20" velocity="2"/>
    <dynamics damping="0.1" friction="0.05"/></joint>
  <joint name="rail" type="prismatic"><parent link="arm"/><child link="slide"/><origin xyz="0 0 0.2"/>
    <axis xyz="1 0 0"/><limit lower="-0.2" upper="0.2" effort="10" velocity="1"/><dynamics damping="1"/></joint>
  <joint name="grip" type="continuous"><parent link="slide"/><child link="finger"/><origin xyz="0 0 0.1"/>
    <axis xyz="0 0 1"/><mimic joint="rail" multiplier="2" offset="0.1"/></joint>
  <joint name="sway" type="planar"><parent link="arm"/><child link="plate"/><axis xyz="0 0 1"/></joint>
  <joint name="flange" type="fixed"><parent link="finger"/><child link="tool"/></joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="elbow"/>
    <actuator name="motor"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>
  <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="elbow"><command_interface name="velocity"><param name="min">-2</param><param name="max">2</param>
      </command_interface><state_interface name="position"><param name="initial_value">0.3</param></state_interface>
      <state_interface name="velocity"/></joint>
    <joint name="rail"><command_interface name="position"/><state_interface name="position"/></joint>
    <joint name="grip"><param name="mimic">rail</param><param name="multiplier">2</param>
      <state_interface name="position"/></joint>
  </ros2_control>
  <gazebo reference="base"><mu1>0.9</mu1><mu2 value="0.8"/><selfCollide>true</selfCollide>
    <material>Gazebo/Red</material></gazebo>
  <gazebo><plugin filename="gz_ros2_control-system" name="c"><ros><namespace>r</namespace></ros></plugin></gazebo>
</robot>"""

NUMBERS = [
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "1e150",
    "1e30",
    "1e9",
    "1e-9",
    "1e-300",
    "-1",
    "0",
    "-0",
    "1",
    "100",
]
TEXTS = [
    "",
    " ",
    "text",
    "1 2",
    "0 0 0",
    "1e308 0 0",
    "0 0 0 0",
    "é",
    "true",
    "0x10",
    "1_000",
    "1,5",
    "world",
    "~",
    "..",
    "/",
]
TAGS = [
    "link",
    "joint",
    "visual",
    "collision",
    "inertial",
    "geometry",
    "box",
    "mesh",
    "limit",
    "mimic",
    "axis",
    "other",
]
TAGS += [
    "parent",
    "child",
    "origin",
    "mass",
    "inertia",
    "cylinder",
    "sphere",
    "material",
    "color",
    "dynamics",
    "gazebo",
]
JOINT_TYPES = ["fixed", "revolute", "continuous", "prismatic", "planar", "floating", "ball", ""]
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")

KINDS = ["number", "number", "number", "value", "drop", "double", "retag", "drop_attribute", "rename_attribute"]
KINDS += ["swap", "move", "type", "text"]
MUTATIONS = st.lists(
    st.tuples(st.sampled_from(KINDS), st.integers(0, 999), st.integers(0, 99), st.integers(0, 999)),
    min_size=1,
    max_size=4,
)


def mutate(text: str, mutations: list[tuple[str, int, int, int]], kept: float | None) -> str:
    """A URDF after some mutations: what to do, to which element, to which of its attributes, with which value."""
    root = etree.fromstring(text)
    for kind, where, which, what in mutations:
        elements = [element for element in root.iter() if isinstance(element.tag, str)]
        numbers = [
            (element, name) for element in elements for name, value in element.attrib.items() if NUMBER.search(value)
        ]
        if kind == "number" and numbers:
            element, name = numbers[where % len(numbers)]
            found = list(NUMBER.finditer(element.get(name)))
            match = found[which % len(found)]
            number = NUMBERS[what % len(NUMBERS)]
            element.set(name, element.get(name)[: match.start()] + number + element.get(name)[match.end() :])
            continue
        _change(kind, elements, elements[where % len(elements)], which, what)
    text = etree.tostring(root, encoding="unicode")
    return text if kept is None else text[: int(kept * len(text))]


def _change(kind: str, elements: list[etree._Element], element: etree._Element, which: int, what: int) -> None:
    parent, names = element.getparent(), list(element.attrib)
    name = names[which % len(names)] if names else None
    other = elements[what % len(elements)]
    if kind == "drop" and parent is not None:
        parent.remove(element)
    elif kind == "double" and parent is not None:
        parent.insert(what % (len(parent) + 1), deepcopy(element))
    elif kind == "retag":
        element.tag = TAGS[what % len(TAGS)]
    elif kind == "value" and name is not None:
        element.set(name, TEXTS[what % len(TEXTS)])
    elif kind == "drop_attribute" and name is not None:
        del element.attrib[name]
    elif kind == "rename_attribute" and name is not None:
        value = element.attrib.pop(name)
        element.set(["name", "value", "other", "xyz", "joint", "link"][what % 6], value)
    elif kind == "swap" and name is not None:
        values = [each.get(name) for each in elements if each.get(name) is not None]
        element.set(name, values[what % len(values)])
    elif kind == "move" and parent is not None and element not in other.iterancestors() and other is not element:
        other.append(element)
    elif kind == "type" and element.get("type") is not None:
        element.set("type", JOINT_TYPES[what % len(JOINT_TYPES)])
    elif kind == "text":
        element.text = (NUMBERS + TEXTS)[what % len(NUMBERS + TEXTS)]


def good_robots() -> list[str]:
    packages = PackageIndex((), {})
    return [
        EVERYTHING,
        *(expand_xacro(packages.resolve(file), {"robot_name": "r"}, packages)[0] for file in (ROVER, ARM)),
    ]


def _serve(connection, folder: Path) -> None:
    """In the worker: texts of robots come in, what became of each goes out."""
    os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
    (folder / "tip.stl").write_bytes(trimesh.creation.cone(1.0, 1.0).export(file_type="stl"))
    while True:
        text, without = connection.recv()
        (folder / "robot.urdf").write_text(text, encoding="utf-8")
        connection.send(_outcome(folder / "robot.urdf", without))


def _outcome(file: Path, without: list[str]) -> str:
    """``works``, ``refused: …`` or ``failed: …``."""
    try:
        twin = TwinBuilder().robot("r", file, xyz=(0, 0, 0.5), without_repairs=without).build()
        twin.advance_to(0.01)
        state = twin.robot_state("r")
        numbers = [*state.positions, *state.velocities, *state.efforts, *state.base_pose]
        numbers += twin.plant.GetPositionsAndVelocities(twin.plant.GetMyContextFromRoot(twin.context)).tolist()
        if not all(isfinite(number) for number in numbers):
            return f"failed: the state is not finite: {state}"
    except TwinError as error:
        text = str(error)
        return f"refused: {text}" if text.strip() and "\n" not in text else f"failed: no paragraph: {text!r}"
    except BaseException:  # SystemExit too
        return f"failed: {traceback.format_exc()}"
    return "works"


class Worker:
    """A process that builds twins, started again when it dies or hangs."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._process: multiprocessing.process.BaseProcess | None = None

    def outcome(self, text: str, without: list[str] | None = None) -> str:
        if self._process is None:
            self._start()
        self._connection.send((text, without or []))
        try:
            if self._connection.poll(LONGEST):
                return self._connection.recv()
            self.stop()
        except (EOFError, ConnectionResetError):
            code = self._process.exitcode
            self.stop()
            return f"failed: the process died (exit code {code})"
        return f"failed: no answer within {LONGEST:g} s"

    def stop(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None

    def _start(self) -> None:
        spawn = multiprocessing.get_context("spawn")
        self._connection, its_end = spawn.Pipe()
        self._process = spawn.Process(target=_serve, args=(its_end, self._folder), daemon=True)
        self._process.start()
        its_end.close()
        self._connection.send((EVERYTHING, []))
        assert self._connection.poll(60)  # the first twin takes the time of the imports
        self._connection.recv()


@pytest.fixture(scope="module")
def worker(tmp_path_factory) -> Iterator[Worker]:
    worker = Worker(tmp_path_factory.mktemp("robots"))
    yield worker
    worker.stop()


@pytest.fixture(scope="module")
def robots() -> list[str]:
    return good_robots()


def fuzz(worker: Worker, robots: list[str], examples: int) -> None:
    @settings(
        max_examples=examples,
        derandomize=True,
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    @given(
        robot=st.sampled_from(range(len(robots))),
        mutations=MUTATIONS,
        kept=st.one_of(*[st.none()] * 9, st.floats(0.0, 1.0)),
        without=st.one_of(st.just([]), st.lists(st.sampled_from(REPAIRS), max_size=3, unique=True), st.just(REPAIRS)),
    )
    def run_or_refuse(
        robot: int, mutations: list[tuple[str, int, int, int]], kept: float | None, without: list[str]
    ) -> None:
        text = mutate(robots[robot], mutations, kept)
        outcome = worker.outcome(text, without)
        assert not outcome.startswith("failed"), f"{outcome}\n\nWithout the repairs {without}, the robot:\n{text}"

    run_or_refuse()


@pytest.mark.parametrize(("index", "what"), [(6, "joint joint_2"), (16, "joint joint_2")])
def test_a_state_that_is_no_longer_finite_names_the_robot_and_its_joint(index, what):
    twin = TwinBuilder().robot("arm_1", ARM).robot("arm_2", ARM, xyz=(2, 0, 0)).build()
    context = twin.plant.GetMyMutableContextFromRoot(twin.context)
    context.get_mutable_discrete_state_vector().SetAtIndex(index, float("nan"))
    with pytest.raises(RunError, match=f"{what} of robot 'arm_2' is no longer at a finite position"):
        twin.advance_to(0.01)


def test_a_robot_that_drake_refuses_is_named_with_its_file_and_drakes_reason(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(EVERYTHING.replace('size="0.2 0.2 0.2"', ""), encoding="utf-8")
    with pytest.raises(InputError, match=rf"^{file}: Drake refuses robot 'r': .*size"):
        TwinBuilder().robot("r", file, without_repairs=["shape_without_size"]).build()


def test_the_good_robots_run(worker, robots):
    assert [worker.outcome(robot) for robot in robots] == ["works"] * len(robots)


def test_a_mutated_robot_runs_or_is_refused_in_one_paragraph(worker, robots):
    fuzz(worker, robots, int(os.environ.get("DRAKE_TWIN_FUZZ_EXAMPLES", "500")))


@pytest.mark.slow
def test_thousands_of_mutated_robots_run_or_are_refused_in_one_paragraph(worker, robots):
    fuzz(worker, robots, 3000)
