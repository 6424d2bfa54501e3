"""Going back to a moment: in memory, from a file, in another process."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from conftest import ARM, rovers
from pydrake.geometry import ProximityProperties, Role, RoleAssign
from pydrake.multibody.plant import CoulombFriction

from drake_twin import Twin, TwinBuilder
from drake_twin.errors import InputError
from drake_twin.messages import float64_multi_array
from drake_twin.scenario import Robot, World, absolute_files
from drake_twin.twin import session
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.snapshot import Snapshot

WHEELS = "/robot_1/forward_velocity_controller/commands"

CONTROLLERS = """controller_manager:
  ros__parameters:
    joint_state_broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
    arm_controller: {type: joint_trajectory_controller/JointTrajectoryController}
    gripper: {type: velocity_controllers/JointGroupVelocityController}
arm_controller:
  ros__parameters:
    joints: [joint_1, joint_2, joint_3]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
gripper: {ros__parameters: {joints: [joint_4], command_timeout: 0.4}}
"""


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "controllers.yaml").write_text(CONTROLLERS)
    twin = TwinBuilder().robot("arm", ARM, controllers=tmp_path / "controllers.yaml").build()
    point = {"positions": [1.0, 0.5, -0.5], "time_from_start": 2.0}
    goal = {"joint_names": ["joint_1", "joint_2", "joint_3"], "points": [point]}
    twin.graph.send_goal("/arm/arm_controller/follow_joint_trajectory", {"trajectory": goal})
    twin.publish("/arm/gripper/commands", [0.3])
    twin.advance_to(0.25)
    return twin


def on(twin, seconds):
    twin.advance_to(twin.time + seconds)
    return twin.state_sha256()


def test_restoring_resolves_no_path_again(arm, monkeypatch, tmp_path):
    """Not even where the diagram is built again: the files of a snapshot's scenario have been found."""
    arm.entities.spawn(Robot("second", ARM, xyz=(2, 0, 0)))
    two = arm.snapshot()
    arm.entities.delete("second")
    one = arm.snapshot()
    resolved = []
    monkeypatch.setattr(absolute_files, "absolute_path", resolved.append)
    monkeypatch.setattr(absolute_files, "PackageIndex", resolved.append)
    monkeypatch.setattr(session, "with_files_found", resolved.append)
    monkeypatch.chdir(tmp_path)
    arm.restore(two)
    assert arm.robots == ("arm", "second")
    arm.restore(one)
    assert (arm.robots, resolved) == (("arm",), [])


def test_the_present_scenario_is_not_read_again(arm, monkeypatch):
    snapshot = arm.snapshot()
    first = on(arm, 0.1)
    monkeypatch.setattr(session, "ScenarioFile", lambda *_: pytest.fail("it is read again"))
    arm.restore(snapshot)
    assert on(arm, 0.1) == first


def test_a_run_goes_on_from_a_snapshot_as_it_did_the_first_time(arm):
    snapshot = arm.snapshot()
    first = on(arm, 3.0)
    arm.restore(snapshot)
    assert arm.time == 0.25
    assert on(arm, 3.0) == first


def test_taking_a_snapshot_changes_nothing(arm):
    twin = Twin(arm.scenario)
    twin.restore(arm.snapshot())
    twin.advance_to(0.5)
    twin.snapshot()
    assert on(twin, 0.5) == on(arm, 0.75)


def test_what_is_published_and_not_yet_applied_is_in_it():
    twin = rovers(1).build()
    twin.publish(WHEELS, [2, 2, 2, 2])
    snapshot = twin.snapshot()
    first = on(twin, 0.5)
    other = rovers(1).build()
    other.restore(snapshot)
    assert on(other, 0.5) == first
    assert other.robot_state("robot_1").velocities == pytest.approx([2] * 4, rel=0.01)


def test_a_file_takes_a_run_to_another_process_bit_for_bit(arm, tmp_path):
    arm.snapshot().save(tmp_path / "state.json")
    program = (
        "import sys; from drake_twin import Twin; from drake_twin.twin.snapshot import Snapshot;"
        "from drake_twin.scenario.scenario_file import ScenarioFile;"
        "saved = Snapshot.load(sys.argv[1]); twin = Twin(ScenarioFile(saved.scenario, 'x').scenario);"
        "twin.restore(saved); twin.advance_to(twin.time + 5.0); print(twin.state_sha256())"
    )
    command = [sys.executable, "-c", program, str(tmp_path / "state.json")]
    other = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    assert other == on(arm, 5.0)


def test_robots_that_came_and_went_since_are_put_right():
    twin = rovers(2).build()
    twin.publish(WHEELS, [2, 3, 2, 3])
    twin.advance_to(0.3)
    snapshot = twin.snapshot()
    first = on(twin, 0.5)
    twin.entities.delete("robot_2")
    twin.entities.spawn(Robot("new", ARM, xyz=(3, 0, 0)))
    twin.clock.set_time_step(0.01)
    twin.advance_to(1.0)
    twin.restore(snapshot)
    assert twin.robots == ("robot_1", "robot_2")
    assert twin.clock.time_step == 0.001
    assert on(twin, 0.5) == first


def test_a_switch_a_stop_and_a_timed_command_are_in_it():
    twin = rovers(2).command(WHEELS, [3] * 4, time=0.5).build()
    twin.publish("/robot_2/forward_velocity_controller/commands", [5] * 4)
    twin.advance_to(0.2)
    twin.control.emergency_stop("robot_2")
    twin.control.manager("robot_1").switch_controller(deactivate=["joint_state_broadcaster"])
    snapshot = twin.snapshot()
    first = on(twin, 1.0)
    twin.control.clear_emergency_stop("robot_2")
    twin.restore(snapshot)
    assert twin.control.manager("robot_1").active == ("forward_velocity_controller",)
    assert on(twin, 1.0) == first


def test_a_file_is_readable_and_says_its_version(arm, tmp_path):
    file = tmp_path / "state.json"
    arm.snapshot().save(file)
    data = json.loads(file.read_text())
    assert (data["format"], data["version"]) == ("drake_twin saved state", 3)
    assert data["robots"]["arm"]["controllers"]["arm_controller"] == "active"
    assert set(data["robots"]["arm"]["joints"]) >= {"joint_1", "joint_2"}
    assert Snapshot.load(file) == arm.snapshot()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "cannot read a saved state"),
        ("[]", "this is not a saved state of a twin"),
        (
            '{"format": "drake_twin saved state", "version": 7}',
            "the saved state has version 7; 1 to 3 can be read",
        ),
        ('{"format": "drake_twin saved state", "version": 2}', "a saved state has the entries"),
    ],
)
def test_a_file_that_is_none_is_refused_in_words(tmp_path, text, reason):
    (tmp_path / "state.json").write_text(text)
    with pytest.raises(InputError, match=reason):
        Snapshot.load(tmp_path / "state.json")


@pytest.mark.parametrize(
    "spoil",
    [
        lambda data: data["robots"]["arm"].update(state=[0.0]),
        lambda data: data["robots"]["arm"]["controllers"].update(nobody="active"),
        lambda data: data["robots"]["arm"].pop("samples"),
        lambda data: data["robots"]["arm"]["samples"].update(arm_controller={"!": "os:system", "command": "true"}),
        lambda data: data["robots"]["arm"]["samples"].update(arm_controller={"!": "Sample@7"}),
        lambda data: data["commands"].update({"/nobody": None}),
    ],
)
def test_a_state_that_does_not_fit_is_refused_and_the_twin_can_be_used(arm, tmp_path, spoil):
    file = tmp_path / "state.json"
    arm.snapshot().save(file)
    data = json.loads(file.read_text())
    spoil(data)
    file.write_text(json.dumps(data))
    with pytest.raises(InputError):
        arm.restore(Snapshot.load(file))
    arm.advance_to(0.1)
    assert np.isfinite(arm.robot_state("arm").positions).all()


@pytest.mark.parametrize(
    "value", [None, True, 3, 0.1, float("inf"), "x", (1, (2.5,)), [1, "a"], {"a": (1,)}, np.array([[1.5, np.nan]])]
)
def test_plain_data_comes_back_as_it_was(value):
    again = from_plain(json.loads(json.dumps(to_plain(value), allow_nan=False)))
    assert type(again) is type(value)
    np.testing.assert_array_equal(again, value) if isinstance(value, np.ndarray) else None
    assert isinstance(value, np.ndarray) or again == value


def test_a_step_that_waits_for_its_multiple_is_in_it():
    twin = rovers(1).build()
    twin.advance_to(0.503)
    twin.clock.set_time_step(0.01)
    snapshot = twin.snapshot()
    first = on(twin, 0.5)
    other = Twin(twin.scenario)
    other.restore(snapshot)
    assert (on(other, 0.5), other.clock.time_step) == (first, 0.01)


def test_taking_one_changes_nothing_where_a_timed_command_meets_a_published_one():
    def run(take):
        twin = rovers(1).command(WHEELS, [1] * 4, time=0.1).build()
        twin.advance_to(0.1)
        twin.publish(WHEELS, [3] * 4)
        if take:
            twin.restore(twin.snapshot())
        return on(twin, 0.5)

    assert run(True) == run(False)


def test_a_robot_of_the_same_name_and_another_model_is_put_right():
    twin = rovers(2).build()
    twin.publish("/robot_2/forward_velocity_controller/commands", [2, 3, 2, 3])
    twin.advance_to(0.3)
    snapshot = twin.snapshot()
    first = on(twin, 0.5)
    twin.entities.delete("robot_2")
    twin.entities.spawn(Robot("robot_2", ARM, xyz=(3, 0, 0)))
    twin.advance_to(1.0)
    twin.restore(snapshot)
    assert on(twin, 0.5) == first


@pytest.mark.parametrize("other", [{"engine": "cenic", "time_step": 0.01}, {"world": World(gravity=(0, 0, -1.6))}])
def test_a_twin_of_another_engine_or_world_becomes_the_saved_one(other):
    twin = rovers(1).robot("arm", ARM, xyz=(3, 0, 0)).build()
    twin.publish(WHEELS, [2, 3, 2, 3])
    twin.advance_to(0.2)
    snapshot = twin.snapshot()
    first = on(twin, 0.3)
    again = Twin(replace(twin.scenario, **other))
    again.advance_to(0.1)
    again.restore(snapshot)
    assert on(again, 0.3) == first


@pytest.mark.parametrize("entry", sorted(Snapshot.__dataclass_fields__))
@pytest.mark.parametrize("value", [{"a": 5}, [5], "x", -1, float("nan")])
def test_an_entry_of_another_kind_is_refused_in_words(arm, tmp_path, entry, value):
    file = tmp_path / "state.json"
    arm.snapshot().save(file)
    data = json.loads(file.read_text())
    data[entry] = value
    file.write_text(json.dumps(data))
    if (entry, value) == ("time_step", -1):
        return  # the scenario says it
    with pytest.raises(InputError):
        arm.restore(Snapshot.load(file))
    arm.advance_to(arm.time + 0.01)


@pytest.mark.parametrize("text", ["[" * 100_000, "1" * 5000, "\x00"])
def test_a_file_that_goes_beyond_json_is_refused(tmp_path, text):
    (tmp_path / "state.json").write_text(text)
    with pytest.raises(InputError, match="cannot read a saved state"):
        Snapshot.load(tmp_path / "state.json")


@pytest.mark.parametrize("nothing", [None, "state.json", {}])
def test_what_is_no_snapshot_is_not_restored(arm, nothing):
    with pytest.raises(InputError, match="is not a Snapshot"):
        arm.restore(nothing)


def test_a_file_that_cannot_be_finished_stays_as_it_was(arm, tmp_path, monkeypatch):
    file = tmp_path / "state.json"
    arm.snapshot().save(file)
    before = file.read_text()
    arm.advance_to(0.5)

    def stopped(descriptor):
        raise KeyboardInterrupt

    monkeypatch.setattr("os.fsync", stopped)
    with pytest.raises(KeyboardInterrupt):
        arm.snapshot().save(file)
    assert file.read_text() == before
    assert [item.name for item in tmp_path.iterdir() if item.suffix == ".part"] == []


def test_a_command_that_was_saved_as_a_message_holds_as_its_numbers():
    twin = rovers(1).build()
    twin.publish(WHEELS, [2.0] * 4)
    twin.advance_to(0.1)
    saved, expected = twin.snapshot(), twin.state_sha256()
    message = twin.graph.command(WHEELS)
    twin.restore(replace(saved, commands={WHEELS: to_plain(message)}))
    assert twin.state_sha256() == expected
    with pytest.raises(InputError, match="does not fit"):
        twin.restore(replace(saved, commands={WHEELS: to_plain(float64_multi_array([2.0]))}))


def test_the_hash_is_of_all_that_decides_how_a_twin_goes_on():
    def changed(change):
        twin = rovers(1).build()
        twin.advance_to(0.1)
        change(twin)
        return twin.state_sha256()

    def heavier(twin):
        twin.plant.GetBodyByName("robot_1_base_link").SetMass(twin.plant.GetMyContextFromRoot(twin.context), 7.0)

    hashes = [
        changed(change)
        for change in (
            lambda twin: None,
            lambda twin: twin.publish(WHEELS, [5.0] * 4),  # which waits for the next step
            lambda twin: twin.publish(WHEELS, [6.0] * 4),
            lambda twin: twin.clock.set_time_step(0.003),  # which waits for a time that both steps meet
            lambda twin: twin.entities.apply_wrench("robot_1::robot_1_base_link", force=(1, 0, 0), duration=1),
            heavier,
        )
    ]
    assert len(set(hashes)) == len(hashes)
    assert hashes[0] == changed(lambda twin: twin.subscribe("/tf", print))


def test_what_somebody_has_changed_in_the_plant_is_there_again():
    twin, other = rovers(1).build(), rovers(1).build()
    body = twin.plant.GetBodyByName("robot_1_base_link")
    body.SetMass(twin.plant.GetMyContextFromRoot(twin.context), 7.0)
    other.restore(twin.snapshot())
    mass = other.plant.GetBodyByName("robot_1_base_link").get_mass(other.plant.GetMyContextFromRoot(other.context))
    assert mass == 7.0
    for each in (twin, other):
        each.advance_to(0.2)
    assert twin.state_sha256() == other.state_sha256()
    other.reset()
    twin.restore(other.snapshot())
    assert body.get_mass(twin.plant.GetMyContextFromRoot(twin.context)) != 7.0


def set_friction(twin, shape, friction):
    """As a user does with Drake's own means."""
    scene_graph = twin.diagram.GetSubsystemByName("scene_graph")
    context = scene_graph.GetMyContextFromRoot(twin.context)
    geometry = geometry_of(twin, shape)
    properties = ProximityProperties(scene_graph.model_inspector().GetProximityProperties(geometry))
    properties.UpdateProperty("material", "coulomb_friction", CoulombFriction(friction, friction))
    scene_graph.AssignRole(context, twin.plant.get_source_id(), geometry, properties, RoleAssign.kReplace)


def geometry_of(twin, shape):
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    return next(item for item in inspector.GetAllGeometryIds(Role.kProximity) if inspector.GetName(item) == shape)


def friction_of(twin, shape):
    context = twin.diagram.GetSubsystemByName("scene_graph").GetMyContextFromRoot(twin.context)
    inspector = twin.diagram.GetSubsystemByName("scene_graph").get_query_output_port().Eval(context).inspector()
    properties = inspector.GetProximityProperties(geometry_of(twin, shape))
    return properties.GetProperty("material", "coulomb_friction").static_friction()


def test_friction_that_somebody_has_changed_is_in_state_and_hash_and_stays_where_others_come_and_go():
    twin, other = rovers(2).build(), rovers(2).build()
    untouched = twin.state_sha256()
    usual = friction_of(twin, "robot_1::body")
    set_friction(twin, "robot_1::body", 0.05)
    assert twin.state_sha256() != untouched
    other.restore(twin.snapshot())
    assert friction_of(other, "robot_1::body") == 0.05
    assert other.state_sha256() == twin.state_sha256()
    twin.entities.spawn(Robot("new", ARM, xyz=(3, 0, 0)))
    assert (friction_of(twin, "robot_1::body"), friction_of(twin, "robot_2::body")) == (0.05, usual)
    twin.entities.delete("new")
    twin.reset()
    assert friction_of(twin, "robot_1::body") == usual


def test_all_that_can_be_changed_in_a_plant_is_in_its_parameters():
    from pydrake.math import RigidTransform
    from pydrake.multibody.tree import FixedOffsetFrame, SpatialInertia

    twin, other = rovers(1).build(), rovers(1).build()
    plant, context = twin.plant, twin.plant.GetMyContextFromRoot(twin.context)
    instance = plant.GetModelInstanceByName("robot_1")
    joint = plant.get_joint(plant.GetJointIndices(instance)[-1])
    motor = plant.get_joint_actuator(plant.GetJointActuatorIndices(instance)[0])
    frames = (plant.get_frame(index) for index in plant.GetFrameIndices(instance))
    frame = next(frame for frame in frames if isinstance(frame, FixedOffsetFrame))
    inertia = SpatialInertia.SolidBoxWithMass(3.0, 0.1, 0.2, 0.3)
    changes = [
        lambda: plant.GetBodyByName("robot_1_base_link").SetSpatialInertiaInBodyFrame(context, inertia),
        lambda: joint.SetDampingVector(context, [0.7] * joint.num_velocities()),
        lambda: joint.Lock(context),
        lambda: joint.Unlock(context),
        lambda: motor.SetRotorInertia(context, 0.02),
        lambda: motor.SetGearRatio(context, 3.0),
        lambda: frame.SetPoseInParentFrame(context, RigidTransform([0.1, 0.2, 0.3])),
    ]
    hashes = [twin.state_sha256()]
    for change in changes:
        change()
        hashes.append(twin.state_sha256())
        other.restore(twin.snapshot())
        assert other.state_sha256() == hashes[-1]
    assert len(set(hashes)) == len(changes)  # a joint that is unlocked again is as it was
    twin.advance_to(0.1)
    other.advance_to(0.1)
    assert twin.state_sha256() == other.state_sha256()


def test_what_is_saved_names_no_module_so_that_code_may_move(arm, tmp_path):
    arm.snapshot().save(tmp_path / "state.json")
    text = (tmp_path / "state.json").read_text()
    assert '"drake_twin.' not in text
    assert '"ServoAssignment@1"' in text


def test_two_classes_cannot_be_saved_under_one_name():
    from drake_twin.saved import saved

    class Other:
        pass

    with pytest.raises(ValueError, match="two classes are saved as Sample@1"):
        saved("Sample")(Other)


def test_a_class_that_is_not_registered_is_named():
    from dataclasses import make_dataclass

    from drake_twin.twin.plain_data import to_plain

    with pytest.raises(TypeError, match="Memory cannot be saved: register it with @saved"):
        to_plain(make_dataclass("Memory", [])())
