"""What makes a twin fast, as counts that repeat, so that a regression fails whatever the machine does besides."""

import collections
import gc
import importlib
import pkgutil
import sys

import numpy as np
import pytest
from conftest import ARM, rovers
from pydrake.systems.framework import Diagram, LeafSystem

from drake_twin import TwinBuilder, systems
from drake_twin.systems.witnessless_system import WitnesslessSystem

COMMANDS = "/robot_1/forward_velocity_controller/commands"
TRAJECTORIES = """controller_manager: {ros__parameters: {update_rate: 100,
  arm: {type: joint_trajectory_controller/JointTrajectoryController}}}
arm: {ros__parameters: {joints: [joint_1, joint_2], command_interfaces: [position],
  state_interfaces: [position, velocity]}}
"""


def driving(count):
    twin = rovers(count).build()
    for robot in twin.robots:
        twin.publish(f"/{robot}/forward_velocity_controller/commands", [2.0] * 4)
    twin.advance_to(0.1)
    return twin


def listening(twin, *ends, rate=50):
    """Subscribes to all topics with these ends; returns what arrives."""
    received = []
    for topic in twin.graph.topics():
        if topic.endswith(ends):
            twin.subscribe(topic, received.append, rate)
    return received


def python_calls(twin, until, first=lambda: None):
    """Function name → how often Python calls it while something is done first, and a twin advances."""
    calls = collections.Counter()

    def count(frame, event, argument):
        # A newer pydrake hands vectors over by NumPy's copy, which is written in Python.
        if event == "call" and not frame.f_code.co_filename.endswith("_function_base_impl.py"):
            calls[frame.f_code.co_name] += 1

    sys.setprofile(count)
    try:
        first()
        twin.advance_to(until)
    finally:
        sys.setprofile(None)
    return calls


def leaf_systems(diagram):
    """The systems of a diagram that are written in Python."""
    for system in diagram.GetSystems():
        if isinstance(system, Diagram):
            yield from leaf_systems(system)
        elif isinstance(system, LeafSystem) and type(system).__module__.startswith("drake_twin"):
            yield system


@pytest.mark.one_plant
def test_no_python_runs_in_a_physics_step():
    twin = driving(2)
    short, long = python_calls(twin, 0.2), python_calls(twin, 1.2)
    assert sum(long.values()) == sum(short.values()) < 60


@pytest.mark.one_plant
def test_a_physics_step_is_one_discrete_update_of_the_plant_and_nothing_else():
    """An unrestricted update would copy all systems' states, and ask each for its witness functions."""
    twin = driving(2)
    listening(twin, "/joint_states", "/tf", "/clock")
    before = (
        twin._session.physics.simulator.get_num_steps_taken(),
        twin._session.physics.simulator.get_num_discrete_updates(),
    )
    twin.advance_to(1.1)
    after = (
        twin._session.physics.simulator.get_num_steps_taken(),
        twin._session.physics.simulator.get_num_discrete_updates(),
    )
    assert [new - old for new, old in zip(after, before, strict=True)] == [1000, 1000]
    assert twin._session.physics.simulator.get_num_unrestricted_updates() == 0
    assert twin._session.physics.simulator.get_num_publishes() == 0


@pytest.mark.one_plant
def test_a_controller_that_samples_is_updated_at_its_rate_and_no_oftener(tmp_path):
    (tmp_path / "c.yaml").write_text(TRAJECTORIES)
    twin = TwinBuilder().robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    twin.advance_to(0.1)
    assert python_calls(twin, 1.1)["_update_sample"] == 100
    assert twin._session.physics.simulator.get_num_unrestricted_updates() == 110  # at 0 s, and not yet at 1.1 s


def test_a_controller_that_has_not_been_active_is_not_updated_and_starts_like_one_that_has(tmp_path):
    (tmp_path / "c.yaml").write_text(TRAJECTORIES)
    known, new = (
        TwinBuilder()
        .robot("arm", ARM, controllers=tmp_path / "c.yaml", active_controllers=[], inactive_controllers=["arm"])
        .build()
        for _ in range(2)
    )
    known.control.manager("arm").switch_controller(["arm"])
    known.advance_to(0.01)
    known.control.manager("arm").switch_controller(deactivate=["arm"])
    known.advance_to(0.1)
    new.restore(known.snapshot())
    goal = {"joint_names": ["joint_1", "joint_2"], "points": [{"positions": [0.3, 0.2], "time_from_start": 0.5}]}
    for twin in (known, new):
        assert python_calls(twin, 0.15)["_update_sample"] == (5 if twin is known else 0)
        twin.control.manager("arm").switch_controller(["arm"])
        twin.publish("/arm/arm/joint_trajectory", goal)
        assert python_calls(twin, 0.25)["_update_sample"] == 10  # the first at 0.15 s
    assert known.state_sha256() == new.state_sha256()


def test_no_state_of_a_controller_or_servo_is_copied_piece_by_piece(tmp_path):
    """Drake copies all states twice at each update of a controller, and a trajectory may have thousands of points."""
    (tmp_path / "c.yaml").write_text(TRAJECTORIES)
    twin = TwinBuilder().robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    twin.advance_to(0.1)
    twin.publish(
        "/arm/arm/joint_trajectory",
        {"joint_names": ["joint_1", "joint_2"], "points": [{"positions": [0.3, 0.2], "time_from_start": 0.5}]},
    )
    calls = python_calls(twin, 0.2)
    assert calls["_update_sample"] == 10
    assert calls["deepcopy"] == calls["__deepcopy__"] >= 20


def test_drake_looks_for_nothing_in_a_python_system_each_time_it_advances(monkeypatch):
    """It would for witness functions, if it found no method of that name; a newer Drake asks for nothing else."""
    looked_for = []
    for system in {type(system) for system in leaf_systems(driving(1).diagram)}:

        def find(self, name):
            looked_for.append(name)
            return object.__getattribute__(self, name)

        monkeypatch.setattr(system, "__getattribute__", find, raising=False)
    twin = driving(2)
    looked_for.clear()
    for step in range(20):
        twin.advance_to(0.2 + step * 0.01)
    witnesses = "DoGetWitnessFunctions"
    is_remembered = witnesses in vars(WitnesslessSystem)
    if is_remembered:
        assert looked_for == []
    else:
        assert looked_for.count(witnesses) == 20 * len([*leaf_systems(twin.diagram)])
        assert set(looked_for) <= {witnesses, "__class__"}


def test_no_system_lets_drake_look_for_witness_functions():
    for module in pkgutil.iter_modules(systems.__path__):
        for kind in vars(importlib.import_module(f"{systems.__name__}.{module.name}")).values():
            if isinstance(kind, type) and issubclass(kind, LeafSystem) and kind.__module__.startswith("drake_twin"):
                assert issubclass(kind, WitnesslessSystem), kind


@pytest.mark.one_plant
@pytest.mark.parametrize("data", [[3.0] * 4, np.full(4, 3.0)], ids=["list", "array"])
def test_a_command_takes_few_calls_of_python(data):
    twin = driving(2)
    for until in (0.2, 0.3):  # Python remembers at the first one of which kind the data is
        calls = python_calls(twin, until, lambda: twin.publish(COMMANDS, data))
    assert sum(calls.values()) < 80


def test_a_command_is_calculated_once():
    twin = driving(2)
    twin.publish(COMMANDS, [3.0] * 4)
    assert python_calls(twin, 1.1)["_calc_command_interfaces"] == 1


@pytest.mark.parametrize("count", [1, 4])
def test_a_message_is_made_when_it_is_delivered_and_once_for_all_who_listen(count):
    twin = driving(count)
    for _ in range(2):
        listening(twin, "/joint_states", "/tf", "/clock")
    twin.advance_to(0.12)  # the types of messages are made once
    calls = python_calls(twin, 1.12)
    assert calls["_joint_states"] == 50 * count
    assert calls["_message"] == calls["_clock"] == 50
    assert calls["_odometry"] == calls["_dynamic_joint_states"] == 0
    listening(twin, "/ground_truth/odom", "/dynamic_joint_states")
    calls = python_calls(twin, 2.12)
    assert calls["_odometry"] == calls["_dynamic_joint_states"] == 50 * count


def test_a_tick_takes_few_calls_of_python_for_each_robot():
    per_tick = {}
    for count in (1, 5, 1, 5):  # the first ones make what is made once
        twin = driving(count)
        listening(twin, "/joint_states", "/tf", "/clock")
        per_tick[count] = sum(python_calls(twin, 1.1).values()) / 50
    of_a_robot = (per_tick[5] - per_tick[1]) / 4
    assert of_a_robot < 50
    assert per_tick[1] - of_a_robot < 60


def test_a_tick_makes_few_objects_for_each_robot():
    made = {}
    for count in (1, 5, 1, 5):
        twin = driving(count)
        received = listening(twin, "/joint_states", "/tf", "/clock")
        twin.advance_to(0.2)
        gc.collect()
        gc.disable()
        try:
            before = gc.get_count()[0]
            twin.advance_to(1.2)
            made[count] = (gc.get_count()[0] - before) / 50
        finally:
            gc.enable()
        assert len(received) == (2 + count) * 55
    assert (made[5] - made[1]) / 4 < 24


@pytest.mark.one_plant
def test_a_robot_has_few_systems_and_the_twin_few_besides():
    systems = {count: [type(system).__name__ for system in leaf_systems(driving(count).diagram)] for count in (1, 3)}
    assert len(systems[3]) - len(systems[1]) == 2 * 3
    assert sorted(set(systems[1])) == [
        "ClockPublisher",
        "EntityStatePublisher",
        "ForwardCommandController",
        "GroundTruthPublisher",
        "JointServo",
        "JointStateBroadcaster",
        "RobotStatePublisher",
    ]


class Forces(LeafSystem):
    """No generalized forces, with a count of how often Drake asks for them: twice for each solution of a step."""

    def __init__(self, size):
        super().__init__()
        self.asked = 0
        self.DeclareVectorOutputPort("forces", size, self._ask)

    def _ask(self, context, output):
        self.asked += 1
        output.SetFromVector(np.zeros(output.size()))


@pytest.mark.one_plant  # it counts who asks the plant; of islands see tests/islands/test_choice.py
@pytest.mark.parametrize("time_step", [0.001, 0.01])
@pytest.mark.parametrize("topics", [(), ("/joint_states", "/tf", "/clock")], ids=["unheard", "heard"])
def test_a_step_is_solved_once_whoever_listens(time_step, topics):
    """The efforts of joint_states need the solution of the step to come, which that step takes from the cache."""

    def add_forces(builder, parts):
        forces.append(builder.AddSystem(Forces(parts.plant.num_velocities())))
        builder.Connect(forces[-1].get_output_port(), parts.plant.get_applied_generalized_force_input_port())

    forces = []
    twin = rovers(2, time_step=time_step).system(add_forces).build()
    received = [] if not topics else listening(twin, *topics)
    twin.publish(COMMANDS, [2.0] * 4)
    twin.advance_to(0.1)
    forces[-1].GetMyMutableContextFromRoot(twin.context).DisableCaching()
    forces[-1].asked = 0
    twin.advance_to(1.1)
    assert forces[-1].asked == 2 * round(1.0 / time_step)
    assert bool(received) == bool(topics)


def test_efforts_are_not_asked_for_in_vain(tmp_path):
    """They take as long as a step after a command; a robot that has no effort interfaces publishes none."""
    urdf = (
        '<robot name="r"><link name="world"/><link name="a"><inertial><mass value="1"/>'
        '<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="continuous"><parent link="world"/><child link="a"/><axis xyz="0 0 1"/></joint>'
        '<ros2_control name="s" type="system"><hardware><plugin>p</plugin></hardware><joint name="j">'
        '<command_interface name="velocity"/><state_interface name="position"/></joint></ros2_control></robot>'
    )
    (tmp_path / "without.urdf").write_text(urdf)
    effort = '<state_interface name="effort"/></joint></ros2_control>'
    (tmp_path / "with.urdf").write_text(urdf.replace("</joint></ros2_control>", effort))
    calls = {}
    for name in ("with", "without"):
        twin = TwinBuilder().robot("r", tmp_path / f"{name}.urdf").build()
        received = listening(twin, "/joint_states")
        calls[name] = python_calls(twin, 1.0)["with_efforts"]
        assert len(received) == 50
    assert calls == {"with": 50, "without": 0}
