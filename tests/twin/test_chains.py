"""Controllers that write to the references of other controllers, as ros2_control chains them."""

from dataclasses import replace
from math import exp

import numpy as np
import pytest
from made_up_controllers import Manager, controller

from drake_twin import TwinBuilder
from drake_twin.twin.controller_manager import AUTO, BEST_EFFORT, FORCE_AUTO, STRICT

# The controller manager decides

LOW = controller("low", "a/effort", references=("a/position", "a/velocity"), state="active")
MIDDLE = controller("middle", "low/a/position", references=("a/position",), state="active")
HIGH = controller("high", "middle/a/position", "b/effort", state="active")


def manager(*controllers):
    return Manager(LOW, MIDDLE, HIGH, *controllers)


def test_a_failure_deactivates_the_whole_chain_above_and_no_one_else():
    others = (
        controller("lower", "c/effort", references=("a/position",), state="active"),
        controller("over_lower", "lower/a/position", state="active"),
    )
    chain = manager(*others)
    assert set(chain.deactivate_failed("low")) == {"low", "middle", "high"}
    assert chain.active == ("lower", "over_lower")
    (((), stopped),) = chain.switches
    assert set(stopped) == {"low", "middle", "high"}


def test_a_failure_activates_the_fallbacks_of_the_controllers_above_as_well():
    spare = controller("spare", "b/effort", state="inactive")
    chain = Manager(LOW, replace(MIDDLE, fallbacks=("spare",)), spare)
    assert set(chain.deactivate_failed("low")) == {"low", "middle"}
    assert chain.active == ("spare",)


def test_a_failure_leaves_what_it_writes_to_active():
    chain = manager()
    assert set(chain.deactivate_failed("middle")) == {"middle", "high"}
    assert chain.active == ("low",)
    assert chain.deactivate_failed("middle") == ()


def test_what_is_written_to_is_not_deactivated_alone():
    chain = manager()
    for names in (["low"], ["middle"], ["low", "middle"]):
        response = chain.switch_controller(deactivate=names, strictness=STRICT)
        assert not response
        assert f"controller '{names[-1]}' is written to by" in response.message
        assert chain.switch_controller(deactivate=names, strictness=BEST_EFFORT).message
    assert chain.switches == []
    assert chain.switch_controller(deactivate=["low", "high", "middle"], strictness=STRICT)
    assert chain.active == ()


def test_a_writer_is_not_activated_before_what_it_writes_to():
    chain = manager()
    chain.switch_controller(deactivate=["low", "middle", "high"])
    for names in (["high"], ["middle"], ["high", "middle"]):
        response = chain.switch_controller(names, strictness=STRICT)
        assert not response
        assert "writes to" in response.message
        assert chain.switch_controller(names, strictness=BEST_EFFORT)
        assert chain.active == ()
    assert chain.switch_controller(["high", "middle", "low"], strictness=STRICT)  # in any order
    assert set(chain.active) == {"low", "middle", "high"}


def test_part_of_a_chain_is_started_as_far_as_it_is_whole():
    chain = manager(controller("wide", "c/effort", "middle/a/velocity", problem="its joint is missing"))
    chain.switch_controller(deactivate=["low", "middle", "high"], strictness=STRICT)
    chain.load_controller("wide")
    response = chain.switch_controller(["low", "middle", "wide"], strictness=BEST_EFFORT)
    assert "controller 'wide' is unconfigured" in response.message
    assert set(chain.active) == {"low", "middle"}


def test_a_claim_that_is_held_stops_the_whole_switch():
    chain = manager(controller("rival", "b/effort", state="inactive"))
    chain.switch_controller(["rival"], ["low", "middle", "high"], STRICT)
    for strictness in (BEST_EFFORT, STRICT):  # controller_manager.cpp:4377
        response = chain.switch_controller(["low", "middle", "high"], strictness=strictness)
        assert not response
        assert "b/effort is already claimed by 'rival'" in response.message
        assert chain.active == ("rival",)


@pytest.mark.parametrize("strictness", [BEST_EFFORT, STRICT])
def test_of_two_writers_of_one_reference_neither_is_activated(strictness):
    chain = Manager(
        LOW,
        controller("first", "low/a/position", state="inactive"),
        controller("second", "low/a/position", state="inactive"),
    )
    response = chain.switch_controller(["first", "second"], strictness=strictness)
    assert not response  # controller_manager.cpp:4389-4397
    assert "low/a/position is already claimed by 'first'" in response.message
    assert chain.active == ("low",)


@pytest.mark.parametrize("name", ["low", "middle"])
def test_what_is_written_to_is_not_restarted_alone(name):
    chain = manager()  # controller_manager.cpp:4088-4101, and 2259-2271 for the best effort
    response = chain.switch_controller([name], [name], STRICT)
    assert not response
    assert f"controller '{name}' is written to by" in response.message
    assert chain.switch_controller([name], [name], BEST_EFFORT)
    assert chain.switches == []
    everything = ("low", "middle", "high")
    assert chain.switch_controller(everything, everything, STRICT)
    assert chain.switches == [(everything, everything)]


def test_nothing_is_activated_above_what_is_restarted():
    chain = Manager(LOW, replace(MIDDLE, state="inactive"))
    response = chain.switch_controller(["low", "middle"], ["low"], STRICT)
    assert not response  # controller_manager.cpp:3936-3962
    assert "controller 'middle' writes to 'low', which is to be deactivated" in response.message
    assert chain.switch_controller(["low", "middle"], ["low"], BEST_EFFORT)
    assert chain.switches == [(("low",), ("low",))]


def test_an_activation_is_refused_before_the_deactivation_below_it():
    """Of the two refusals the first leaves the second in place: the writer that stays active."""
    chain = manager(controller("aside", "low/a/velocity", state="inactive"))
    response = chain.switch_controller(["aside"], ["low"], BEST_EFFORT)  # controller_manager.cpp:2041, 2125
    assert "controller 'aside' writes to 'low', which is to be deactivated" in response.message
    assert "controller 'low' is written to by 'middle', which is active" in response.message
    assert chain.switches == []


def test_what_enters_or_leaves_chained_mode_is_restarted():
    chain = manager()  # controller_manager.cpp:2207-2215
    chain.switch_controller(deactivate=["high"], strictness=STRICT)
    chain.switch_controller(deactivate=["middle"], strictness=STRICT)
    chain.switch_controller(["middle", "high"], strictness=STRICT)
    assert chain.switches == [
        (("middle",), ("high", "middle")),
        (("low",), ("middle", "low")),
        (("middle", "high", "low"), ("low",)),
    ]


def test_what_stays_in_chained_mode_is_not_restarted():
    chain = manager(controller("other", "low/a/position", state="inactive"))
    chain.switch_controller(["other"], ["high", "middle"], STRICT)  # controller_manager.cpp:4026-4037
    assert chain.switches == [(("other",), ("high", "middle"))]


def test_all_that_a_writer_writes_to_must_be_active():
    second = controller("second", "b/effort", references=("b/position",), state="inactive")
    both = controller("both", "low/a/velocity", "second/b/position", state="inactive")
    chain = Manager(LOW, second, both)
    response = chain.switch_controller(["both"], strictness=STRICT)
    assert "controller 'both' writes to 'second', which is not active" in response.message
    assert chain.switch_controller(["both", "second"], strictness=STRICT)


def test_a_reference_has_one_writer():
    chain = Manager(LOW, MIDDLE, controller("rival", "low/a/position", "low/a/velocity", state="inactive"))
    response = chain.switch_controller(["rival"], strictness=STRICT)
    assert "command interface low/a/position is already claimed by 'middle'" in response.message
    assert chain.switch_controller(["rival"], ["middle"], STRICT)


def test_a_controller_is_chained_while_one_of_its_references_is_written():
    chain = manager()
    chained = {item.name: item.is_chained for item in chain.list_controllers()}
    assert chained == {"low": True, "middle": True, "high": False}  # a/velocity of the lowest is unused
    chain.switch_controller(deactivate=["high", "middle"])
    assert not any(item.is_chained for item in chain.list_controllers())


def test_references_are_there_once_a_controller_is_configured():
    chain = Manager(LOW, controller("idle", "b/effort", references=("b/position",)))

    def listed():
        return {item.name: item.is_claimed for item in chain.list_hardware_interfaces()[0]}

    before = listed()
    assert before == {"a/effort": True, "b/effort": False, "low/a/position": False, "low/a/velocity": False}
    chain.load_controller("idle")
    assert listed() == before
    chain.configure_controller("idle")
    assert listed() == before | {"idle/b/position": False}
    (item,) = (item for item in chain.list_controllers() if item.name == "idle")
    assert item.reference_interfaces == ("b/position",)


def test_what_a_controller_exports_is_available_while_it_is_active():
    exporter = controller("exporter", "b/effort", references=("b/position",), state="inactive")
    chain = Manager(replace(exporter, exported=("b/velocity",)))

    def available():
        interfaces = (item for items in chain.list_hardware_interfaces() for item in items)
        return {item.name: item.is_available for item in interfaces if item.name.startswith("exporter/")}

    is_active = {"exporter/b/position": True, "exporter/b/velocity": True}
    assert available() == dict.fromkeys(is_active, False)  # controller_manager.cpp:1728-1729, as configured
    chain.switch_controller(["exporter"], strictness=STRICT)
    assert available() == is_active  # 2796-2797
    chain.switch_controller(deactivate=["exporter"], strictness=STRICT)
    assert available() == dict.fromkeys(is_active, False)  # 2560-2561


def test_force_auto_deactivates_all_that_stand_in_the_way():
    rivals = (
        controller("on_a", "low/a/position", state="inactive"),
        controller("on_b", "b/effort", state="inactive"),
    )
    for strictness in (BEST_EFFORT, AUTO):
        chain = manager(*rivals)
        chain.switch_controller(["on_a", "on_b"], strictness=strictness)
        assert chain.active == ("low", "middle", "high")
    chain = manager(*rivals)
    assert not chain.switch_controller(["on_a", "on_b"], strictness=FORCE_AUTO).message
    assert chain.active == ("low", "on_a", "on_b")


@pytest.mark.parametrize(("deactivate", "strictness"), [(["low"], BEST_EFFORT), ([], FORCE_AUTO)])
def test_a_rival_of_a_controller_that_has_to_stay_active_is_not_started(deactivate, strictness):
    chain = manager(controller("rival", "a/effort", state="inactive"))
    chain.switch_controller(["rival"], deactivate, strictness)
    assert not {"low", "rival"} <= set(chain.active)  # both claim a/effort


# A chain in a running twin: a cascade of a position loop over a velocity loop, on a hinge of 0.5 kg·m² without gravity

INERTIA = 0.5  # kg·m²
OMEGA = 6.0  # rad/s, of the critically damped cascade
INNER = 2.0 * OMEGA * INERTIA  # N·m·s/rad
OUTER = 0.5 * OMEGA  # 1/s

ROBOT = f"""<robot name="r"><link name="world"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="continuous"><parent link="world"/><child link="arm"/><axis xyz="0 0 1"/>
<limit velocity="100" effort="1000"/></joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="hinge"><command_interface name="effort"/><state_interface name="position"/>
<state_interface name="velocity"/></joint></ros2_control></robot>"""

# In the parameters file the chain stands from above to below, from below to above, and neither.
ORDERS = [("above", "outer", "inner"), ("inner", "outer", "above"), ("outer", "above", "inner")]

PARAMETERS = {
    "above": (
        "forward_command_controller/ForwardCommandController",
        "{joints: [outer/hinge], interface_name: position}",
    ),
    "outer": (
        "pid_controller/PidController",
        (
            "{dof_names: [inner/hinge], reference_and_state_dof_names: [hinge], command_interface: velocity,"
            f" reference_and_state_interfaces: [position], gains: {{inner/hinge: {{p: {OUTER}}}}}}}"
        ),
    ),
    "inner": (
        "pid_controller/PidController",
        (
            "{dof_names: [hinge], command_interface: effort, reference_and_state_interfaces: [velocity],"
            f" gains: {{hinge: {{p: {INNER}}}}}}}"
        ),
    ),
}


def build(folder, parameters, order, rate=100, **options):
    robot, controllers = folder / "robot.urdf", folder / "controllers.yaml"
    robot.write_text(ROBOT)
    types = "".join(f"    {name}: {{type: {parameters[name][0]}}}\n" for name in order)
    texts = "".join(f"{name}:\n  ros__parameters: {parameters[name][1]}\n" for name in order)
    controllers.write_text(f"controller_manager:\n  ros__parameters:\n    update_rate: {rate}\n{types}{texts}")
    return TwinBuilder(time_step=0.001).robot("r", robot, controllers=controllers, **options).build()


@pytest.mark.parametrize("order", ORDERS)
def test_a_command_goes_down_the_whole_chain_within_one_cycle(tmp_path, order):
    """As ros2_control updates a chain from above in each cycle; here one physics step after the other."""
    twin = build(tmp_path, PARAMETERS, order)
    twin.publish("/r/above/commands", [1.0])
    twin.step(9)  # one less than a cycle
    assert twin.robot_state("r").velocities[0] > 0
    effort = INNER * OUTER * 1.0
    assert twin.robot_state("r").efforts[0] == pytest.approx(effort, rel=1e-6)  # of the first cycle, at rest


@pytest.mark.parametrize("order", ORDERS)
def test_a_cascade_moves_as_its_closed_form(tmp_path, order):
    """J q'' = K_i (K_o (r - q) - q') with K_i = 2 J ω and K_o = ω / 2: critically damped."""
    twin = build(tmp_path, PARAMETERS, order, rate=500)
    twin.publish("/r/above/commands", [1.0])
    for time in (0.1, 0.2, 0.4, 0.8):
        twin.advance_to(time)
        expected = 1.0 - (1.0 + OMEGA * time) * exp(-OMEGA * time)
        assert twin.robot_state("r").positions[0] == pytest.approx(expected, abs=0.01)


def test_a_reference_without_a_writer_stays_as_it_was(tmp_path):
    """Of the position and the velocity only the position is written; the velocity's is that at the activation: 0."""
    parameters = {
        "above": (PARAMETERS["above"][0], "{joints: [pid/hinge], interface_name: position}"),
        "pid": (
            "pid_controller/PidController",
            (
                "{dof_names: [hinge], command_interface: effort, reference_and_state_interfaces: [position, velocity],"
                " gains: {hinge: {p: 3.0, d: 5.0}}}"
            ),
        ),
    }
    twin = build(tmp_path, parameters, ("above", "pid"))
    twin.publish("/r/above/commands", [0.5])
    twin.step(9)
    assert twin.robot_state("r").efforts[0] == pytest.approx(3.0 * 0.5, rel=1e-6)  # and not 5 · 0.5 besides


def test_what_is_below_goes_on_by_its_own_topic_once_the_chain_above_is_off(tmp_path):
    twin = build(tmp_path, PARAMETERS, ORDERS[0])
    manager = twin.control.manager("r")
    twin.publish("/r/above/commands", [1.0])
    twin.advance_to(3.0)
    assert twin.robot_state("r").positions[0] == pytest.approx(1.0, abs=1e-3)
    assert manager.switch_controller(deactivate=["outer", "above"], strictness=STRICT)
    twin.publish("/r/inner/reference", {"values": [0.5]})
    twin.advance_to(4.0)
    assert twin.robot_state("r").velocities[0] == pytest.approx(0.5, rel=1e-3)
    assert np.isfinite(twin.robot_state("r").efforts[0])


def test_what_a_controller_is_told_in_chained_mode_is_never_obeyed(tmp_path):
    """Not in chained mode (chainable_controller_interface.cpp:36), nor after it (controller_manager.cpp:2207-2215)."""
    twin = build(tmp_path, PARAMETERS, ORDERS[0])
    twin.publish("/r/above/commands", [0.0])
    for _ in range(2):
        twin.publish("/r/inner/reference", {"values": [2.0]})
        twin.step(50)
        assert twin.robot_state("r").velocities[0] == 0.0
    twin.publish("/r/inner/reference", {"values": [2.0]})
    assert twin.control.manager("r").switch_controller(deactivate=["outer", "above"], strictness=STRICT)
    twin.step(100)
    assert twin.robot_state("r").velocities[0] == 0.0


def test_a_writer_that_has_written_nothing_leaves_the_topic_below_it_in_force(tmp_path):
    """Other than in ROS 2, where chained mode alone decides; `drake_twin.controllers.deviations` has it."""
    parameters = {
        "writer": (PARAMETERS["above"][0], "{joints: [inner/hinge], interface_name: velocity}"),
        "inner": PARAMETERS["inner"],
    }
    twin = build(tmp_path, parameters, ("writer", "inner"))
    twin.publish("/r/inner/reference", {"values": [0.5]})
    twin.advance_to(1.0)
    assert twin.robot_state("r").velocities[0] == pytest.approx(0.5, rel=1e-3)
    twin.publish("/r/writer/commands", [-0.5])
    twin.publish("/r/inner/reference", {"values": [0.5]})
    twin.advance_to(2.0)
    assert twin.robot_state("r").velocities[0] == pytest.approx(-0.5, rel=1e-3)


def test_what_is_below_forgets_its_last_reference_at_the_end_of_chained_mode(tmp_path):
    twin = build(tmp_path, PARAMETERS, ORDERS[0])
    twin.publish("/r/above/commands", [1.0])
    twin.step(50)
    assert twin.robot_state("r").velocities[0] > 0.1
    assert twin.control.manager("r").switch_controller(deactivate=["outer", "above"], strictness=STRICT)
    twin.step(20)
    assert twin.robot_state("r").efforts[0] <= 0.0  # nothing drives it, and a joint without a command brakes
