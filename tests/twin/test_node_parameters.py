"""Parameters of a robot's controller_manager and robot_state_publisher, and those that wait for a configure."""

import pytest
from conftest import rovers
from two_hinges import hinges, trajectories

from drake_twin.errors import InputError
from drake_twin.twin.replay import replay
from drake_twin.twin.snapshot import Snapshot

ROBOT, MANAGER, PUBLISHER = "robot_1", "controller_manager", "robot_state_publisher"
STRICTNESS = "defaults.switch_controller.strictness"
LIMIT = "diagnostics.threshold.controllers.execution_time.mean_error.warn"


@pytest.fixture
def twin():
    with rovers(2).build() as twin:
        yield twin


def value(twin, node, name, robot=ROBOT):
    return twin.control.parameters(robot, node)[name].value


def test_both_nodes_have_what_they_declare_upstream(twin):
    """The names are those of ros2_control's parameters file and of robot_state_publisher's source, counted by hand."""
    manager = twin.control.parameters(ROBOT, MANAGER)
    limits = [name for name in manager if name.startswith("diagnostics.threshold.")]
    others = {name for name in manager if name not in limits and not name.endswith(".type")}
    assert len(limits) == 20
    assert (manager[LIMIT].value, manager[LIMIT.replace("warn", "error")].value) == (1000.0, 2000.0)
    initial, default = "hardware_components_initial_state", "defaults"
    assert others == {
        *("use_sim_time", "update_rate", "enforce_command_limits", "handle_exceptions", "overruns.print_warnings"),
        *(f"{initial}.{name}" for name in ("unconfigured", "inactive", "shutdown_on_initial_state_failure")),
        *(STRICTNESS, f"{default}.allow_controller_activation_with_inactive_hardware"),
        f"{default}.deactivate_controllers_on_hardware_self_deactivate",
    }
    assert {name for name in others if manager[name].is_read_only} == {
        *("update_rate", "enforce_command_limits", "handle_exceptions"),
        f"{initial}.shutdown_on_initial_state_failure",
        f"{default}.allow_controller_activation_with_inactive_hardware",
        f"{default}.deactivate_controllers_on_hardware_self_deactivate",
    }
    publisher = twin.control.parameters(ROBOT, PUBLISHER)
    own = ["use_sim_time", "robot_description", "publish_frequency", "frame_prefix", "ignore_timestamp"]
    assert list(publisher) == own
    assert all(item.description for item in (*manager.values(), *publisher.values()))


@pytest.mark.parametrize(
    ("node", "name", "given", "reason"),
    [
        (MANAGER, "update_rate", 50, "parameter 'update_rate' cannot be set because it is read-only"),
        (MANAGER, STRICTNESS, "some", f"Parameter '{STRICTNESS}' with the value 'some' is not in the set"),
        (MANAGER, LIMIT, 0.0, "doesn't comply with floating point range"),
        (MANAGER, "forward_velocity_controller.type", "x/Y", "the robot's files give it"),
        (MANAGER, "nothing", 1, "parameter 'nothing' cannot be set because it was not declared"),
        (PUBLISHER, "publish_frequency", 1000.5, "publish_frequency must be between 0.0 and 1000.0"),
        (PUBLISHER, "publish_frequency", 20, "Wrong parameter type"),
        (PUBLISHER, "robot_description", "<robot name='r'/>", "the robot's files give it"),
        (PUBLISHER, "use_sim_time", False, "cannot be false"),
    ],
)
def test_what_is_refused(twin, node, name, given, reason):
    with pytest.raises(InputError, match=reason.replace("(", r"\(")):
        twin.control.set_parameters(ROBOT, node, {name: given})


def test_the_state_publisher_follows_its_rate_and_prefix(twin):
    heard = []
    moving = next(item.child_frame_id for item in twin.latest("/tf").transforms if "wheel" in item.child_frame_id)
    twin.control.set_parameters(ROBOT, PUBLISHER, {"publish_frequency": 5.0, "frame_prefix": "new/"})
    twin.control.set_parameters("robot_2", PUBLISHER, {"publish_frequency": 5.0})  # all are in one message
    twin.subscribe("/tf", lambda message: heard.extend(message.transforms))
    twin.advance_to(1.0)
    link = moving.rpartition("/")[2]
    stamps = [item.header.stamp for item in heard if item.child_frame_id == f"new/{link}"]
    assert moving not in {item.child_frame_id for item in heard}
    assert {5, 6} & {len(stamps)}  # 1 s at 5 Hz, with or without the first moment
    assert value(twin, PUBLISHER, "frame_prefix") == "new/"


def test_the_strictness_of_switches_that_name_none(twin):
    manager = twin.control.manager(ROBOT)
    assert value(twin, MANAGER, STRICTNESS) == "best_effort"
    wanted = ["forward_velocity_controller", "nobody"]
    assert manager.switch_controller(deactivate=wanted).ok
    manager.switch_controller(activate=["forward_velocity_controller"])
    twin.control.set_parameters(ROBOT, MANAGER, {STRICTNESS: "strict"})
    assert not manager.switch_controller(deactivate=wanted).ok
    assert manager.states["forward_velocity_controller"] == "active"


def test_what_has_no_effect_is_kept(twin):
    before = twin.control.manager(ROBOT)
    twin.control.set_parameters(ROBOT, MANAGER, {LIMIT: 5.0})
    twin.control.set_parameters(ROBOT, PUBLISHER, {"ignore_timestamp": True})
    assert (value(twin, MANAGER, LIMIT), value(twin, PUBLISHER, "ignore_timestamp")) == (5.0, True)
    assert twin.control.manager(ROBOT) is before


@pytest.fixture
def arm(tmp_path):
    with hinges(tmp_path, {"c": trajectories("left", "right")}, names=("hinges",)).build() as twin:
        yield twin


def used(twin):
    return next(item.parameters for item in twin.built.plans[0].controllers if item.name == "c").cmd_timeout


def test_what_waits_for_a_configure_is_in_snapshots(arm, tmp_path):
    empty, before, file = arm.snapshot(), arm.state_sha256(), tmp_path / "state.json"
    arm.control.set_parameters("hinges", "c", {"cmd_timeout": 5.0})
    arm.control.set_parameters("hinges", MANAGER, {STRICTNESS: "strict"})
    arm.snapshot().save(file)
    assert arm.state_sha256() != before
    arm.restore(empty)
    assert (value(arm, "c", "cmd_timeout", "hinges"), value(arm, MANAGER, STRICTNESS, "hinges")) == (0.0, "best_effort")
    arm.restore(Snapshot.load(file))
    assert (value(arm, "c", "cmd_timeout", "hinges"), used(arm)) == (5.0, 0.0)
    assert value(arm, MANAGER, STRICTNESS, "hinges") == "strict"
    manager = arm.control.manager("hinges")
    manager.switch_controller(deactivate=["c"])
    manager.configure_controller("c")
    assert used(arm) == 5.0
    assert "c" not in arm.snapshot().later_parameters["hinges"]


def test_a_snapshot_with_a_parameter_that_cannot_be_is_refused(arm):
    state = arm.snapshot()
    for later in (
        {"hinges": {"c": {"none": 1.0}}},
        {"hinges": {"c": {"cmd_timeout": "x"}}},
        {"nobody": {"c": {"x": 1}}},
    ):
        with pytest.raises(InputError):
            arm.restore(Snapshot(**{**vars(state), "later_parameters": later}))


def test_a_replay_sets_what_was_set(arm):
    arm.recorder.begin()
    arm.control.set_parameters("hinges", "c", {"cmd_timeout": 5.0})
    arm.control.set_parameters("hinges", PUBLISHER, {"ignore_timestamp": True, "publish_frequency": 7.0})
    arm.advance_to(0.3)
    with replay(arm.recorder.recording()) as again:
        assert again.state_sha256() == arm.state_sha256()
        assert value(again, PUBLISHER, "publish_frequency", "hinges") == 7.0
        assert value(again, PUBLISHER, "ignore_timestamp", "hinges") is True


def test_a_robot_of_the_same_name_has_nothing_of_the_one_before(twin):
    twin.control.set_parameters(ROBOT, MANAGER, {LIMIT: 5.0})
    robot = twin.scenario.robots[0]
    twin.entities.delete(ROBOT)
    twin.entities.spawn(robot)
    assert value(twin, MANAGER, LIMIT) == 1000.0
