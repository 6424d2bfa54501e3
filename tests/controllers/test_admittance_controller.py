"""The assertions of ros2_controllers' test_admittance_controller.cpp, cited by line, and closed forms."""

from copy import deepcopy
from dataclasses import replace
from math import cos, exp, nan, sin, sqrt

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import Running
from six_axis_arm import ADMITTANCE, ARM, JOINTS, LAYOUT

from drake_twin import TwinBuilder, messages
from drake_twin.controllers.admittance_controller import AdmittanceController
from drake_twin.controllers.base_controller import ControllerSetup, Upstream
from drake_twin.controllers.interface import Interface
from drake_twin.description.robot_description import HardwareSensor, HardwareSystem, Joint, RobotDescription
from drake_twin.errors import CommandError, InputError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.twin.snapshot import Snapshot

KIND = "admittance_controller/AdmittanceController"
STATE = [1.1, 2.2, 3.3, 4.4, 5.5, 6.6]  # test_admittance_controller.hpp:391
NEAR = 0.001  # test_admittance_controller.hpp:57


def changed(given, path, value=None):
    """The parameters with one changed, or left out where no value is given."""
    given = deepcopy(given)
    *above, last = path.split(".")
    where = given
    for name in above:
        where = where[name]
    if value is None:
        del where[last]
    else:
        where[last] = value
    return given


def arm(wrench=(0.0,) * 6, velocities=(0.0,) * 6, upstream=None, **more):
    parameters = parameters_of(KIND, **{**ADMITTANCE, **more})
    claims = AdmittanceController.claimed_interfaces(parameters, ARM)
    setup = ControllerSetup("dut", parameters, claims, ARM, LAYOUT, upstream=upstream or {})
    ports = {name: [nan] * item.size for name, item in (upstream or {}).items()}
    return Running(AdmittanceController(setup), state=[*STATE, *velocities], wrench=list(wrench), **ports)


@pytest.mark.parametrize(
    "name",
    [
        "admittance.mass",
        "admittance.selected_axes",
        "admittance.stiffness",
        "command_interfaces",
        "control.frame.id",
        "fixed_world_frame.frame.id",
        "ft_sensor.frame.id",
        "ft_sensor.name",
        "gravity_compensation.CoG.pos",
        "gravity_compensation.frame.id",
        "joints",
        "kinematics.base",
        "kinematics.plugin_name",
        "kinematics.plugin_package",
        "kinematics.tip",
        "state_interfaces",
    ],
)
def test_a_parameter_without_default_is_required(name):  # :25
    with pytest.raises(InputError, match=f"the parameter '{name}' is missing"):
        parameters_of(KIND, **changed(ADMITTANCE, name))


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("gravity_compensation.CoG.pos", [1, 2, 3, 4], "pos has 4 elements, where 3 are needed"),
        ("admittance.stiffness", [1, 2, 3], "stiffness has 3 elements, where 6 are needed"),
        ("admittance.stiffness", [-1, -2, 3, 4, 5, 6], "-1.0 is below 0"),
        ("admittance.mass", [1, 2, 3], "mass has 3 elements, where 6 are needed"),
        ("admittance.mass", [-1, -2, 3, 4, 5, 6], "-1.0 is below 0.0001"),
        ("admittance.damping_ratio", [1, 2, 3], "damping_ratio has 3 elements, where 6 are needed"),
        ("admittance.selected_axes", [1, 2, 3], "1 is neither true nor false"),
    ],
)
def test_a_wrong_parameter_is_refused(name, value, text):  # :73
    with pytest.raises(InputError, match=text):
        parameters_of(KIND, **changed(ADMITTANCE, name, value))


def test_parameters_are_read():
    parameters = parameters_of(KIND, **ADMITTANCE)
    assert parameters.joints == JOINTS  # :84 to :90
    assert parameters.command_interfaces == ("position",)  # :92 to :100
    assert parameters.state_interfaces == ("position",)  # :102 to :109
    assert parameters.ft_sensor.name == "ft_sensor_name"  # :111
    assert parameters.kinematics.base == "base_link"  # :112
    assert parameters.ft_sensor.frame.id == "link_6"  # :113
    gains = parameters.admittance
    assert gains.selected_axes == (True,) * 6  # :115 to :123
    assert gains.mass == (5.5, 6.6, 7.7, 8.8, 9.9, 10.10)  # :125 to :132
    assert gains.damping_ratio == (2.828427,) * 6  # :134 to :142
    assert gains.stiffness == (214.1, 214.2, 214.3, 214.4, 214.5, 214.6)  # :144 to :152


def test_defaults_are_those_of_upstream():
    given = deepcopy(ADMITTANCE)
    for path in ("chainable_command_interfaces", "kinematics.alpha", "ft_sensor.filter_coefficient"):
        given = changed(given, path)
    parameters = parameters_of(KIND, **changed(given, "gravity_compensation.CoG.force"))
    assert parameters.chainable_command_interfaces == ("position", "velocity")
    assert (parameters.kinematics.alpha, parameters.ft_sensor.filter_coefficient) == (0.01, 0.05)
    assert (parameters.gravity_compensation.CoG.force, parameters.admittance.joint_damping) == (0.0, 5.0)
    assert parameters.enable_parameter_update_without_reactivation is True


def test_interfaces():
    parameters = parameters_of(KIND, **ADMITTANCE)
    claims = AdmittanceController.claimed_interfaces(parameters, ARM)
    assert claims == tuple(Interface(name, "position") for name in JOINTS)  # :162, :166
    assert AdmittanceController.state_interfaces(parameters) == (  # :170, :173
        "ft_sensor_name/force.x",
        "ft_sensor_name/force.y",
        "ft_sensor_name/force.z",
        "ft_sensor_name/torque.x",
        "ft_sensor_name/torque.y",
        "ft_sensor_name/torque.z",
    )
    references = AdmittanceController.reference_interfaces(parameters, ARM)
    assert len(references) == 12  # :178
    for index, name in enumerate(JOINTS):
        assert references[index] == Interface(name, "position")  # :183 to :187
        assert references[index + 6] == Interface(name, "velocity")  # :188 to :195


def test_it_is_activated():
    run = arm()
    assert len(run.commands()) == 6  # :204
    assert run.controller.sample(run.context).active  # :206


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("state_interfaces", ["velocity"], "the state interface 'position' is needed"),  # :213
        ("chainable_command_interfaces", ["invalid_interface"], "unknown value 'invalid_interface'"),  # :249
        ("command_interfaces", ["effort"], "unknown value 'effort'"),
        ("command_interfaces", ["acceleration"], "the twin does not command accelerations"),
        ("command_joints", ["a"], "command_joints has 1 elements and joints has 6"),
    ],
)
def test_wrong_interfaces_are_refused(name, value, text):
    with pytest.raises(InputError, match=text):
        parameters_of(KIND, **{**ADMITTANCE, name: value})


def test_velocities_alone_may_be_commanded():  # :221 to :225
    run = arm(command_interfaces=["velocity"])
    assert run.controller.claims == tuple(Interface(name, "velocity") for name in JOINTS)
    run.advance(0.01)
    assert run.controller.fault(run.context) is None
    np.testing.assert_allclose(run.commands(), run.output("status").joint_state.velocity)


@pytest.mark.parametrize("name", ["position", "velocity"])  # :233, :241
def test_one_reference_a_joint_is_enough(name):
    parameters = parameters_of(KIND, **{**ADMITTANCE, "chainable_command_interfaces": [name]})
    references = AdmittanceController.reference_interfaces(parameters, ARM)
    assert references == tuple(Interface(joint, name) for joint in JOINTS)


def test_it_is_updated_deactivated_and_activated_again():
    run = arm()
    run.advance(0.01)
    assert run.controller.fault(run.context) is None  # :259, :297, :331
    run.controller.deactivate(run.context)  # :270, :279
    assert np.isnan(run.commands()).all()
    assert run.output("status") is None
    run.controller.activate(run.context)  # :281
    run.advance(0.02)
    assert run.controller.fault(run.context) is None  # :283
    assert np.isfinite(run.commands()).all()


def test_the_command_is_near_the_state_before_and_after_a_reference():
    run = arm()
    run.advance(0.01)
    np.testing.assert_allclose(run.commands(), STATE, atol=NEAR)  # :338
    point = messages.JointTrajectoryPoint(np.array(STATE), np.zeros(6), np.zeros(0), np.zeros(0), None)
    run.send("joint_references", point)
    run.advance(0.02)
    assert run.commands()[0] == pytest.approx(STATE[0], abs=NEAR)  # :356


def test_the_status_has_the_frames_and_gains():
    run = arm()
    run.advance(0.01)
    message = run.output("status")
    assert message.ref_trans_base_ft.header.frame_id == "base_link"  # :379
    assert message.ref_trans_base_ft.child_frame_id == "link_6"  # :381
    assert message.admittance_position.header.frame_id == "base_link"  # :383
    assert message.admittance_position.child_frame_id == "admittance_offset"  # :385
    # what upstream's test has as comments
    assert message.wrench_base.header.frame_id == "base_link"  # :304
    assert message.wrench_base.wrench.force.z > 0.0  # :307: the weight is taken off
    assert message.joint_state.name == list(JOINTS)  # :315
    for values in (message.joint_state.position, message.joint_state.velocity, message.joint_state.effort):
        assert np.isfinite(values).all()  # :316 to :318
    assert message.ft_sensor_frame.data == "link_6"
    assert message.selected_axes.data.tolist() == [1] * 6
    damping = 2 * 2.828427 * np.sqrt(np.array(ADMITTANCE["admittance"]["mass"]) * ADMITTANCE["admittance"]["stiffness"])
    np.testing.assert_allclose(message.damping.data, damping)
    assert message.mass.data.tolist() == ADMITTANCE["admittance"]["mass"]
    assert message.stiffness.data.tolist() == ADMITTANCE["admittance"]["stiffness"]
    assert messages.type_store().serialize_cdr(message, message.__msgtype__)


SLIDER = RobotDescription(
    name="slider",
    links=("base", "cart"),
    joints=(Joint("slide", "prismatic", "base", "cart", axis=(1.0, 0.0, 0.0)),),
    systems=(HardwareSystem("h", "system", "", sensors=(HardwareSensor("fts"),)),),
)
SLIDER_LAYOUT = StateLayout(size=2, positions={"slide": 0}, velocities={"slide": 1}, efforts={})
MASS, DAMPING_RATIO, STIFFNESS, FORCE = 2.0, 0.5, 50.0, 5.0
SLIDING = {
    "joints": ["slide"],
    "command_interfaces": ["position"],
    "state_interfaces": ["position"],
    "kinematics": {"plugin_name": "p", "plugin_package": "k", "base": "base", "tip": "cart", "alpha": 1e-12},
    "ft_sensor": {"name": "fts", "frame": {"id": "cart"}, "filter_coefficient": 1.0},
    "control": {"frame": {"id": "cart"}},
    "fixed_world_frame": {"frame": {"id": "base"}},
    "gravity_compensation": {"frame": {"id": "cart"}, "CoG": {"pos": [0.0, 0.0, 0.0]}},
    "admittance": {
        "selected_axes": [True, False, False, False, False, False],
        "mass": [MASS] * 6,
        "damping_ratio": [DAMPING_RATIO] * 6,
        "stiffness": [STIFFNESS] * 6,
        "joint_damping": 0.0,
    },
}


def slider(wrench=(0.0,) * 6, period=1e-3, upstream=None, **more):
    parameters = parameters_of(KIND, **{**SLIDING, **more})
    claims = AdmittanceController.claimed_interfaces(parameters, SLIDER)
    setup = ControllerSetup("dut", parameters, claims, SLIDER, SLIDER_LAYOUT, period, upstream=upstream or {})
    ports = {name: [nan] * item.size for name, item in (upstream or {}).items()}
    return Running(AdmittanceController(setup), state=[0.0, 0.0], wrench=list(wrench), **ports)


def follow(run, steps, period=1e-3):
    """The positions that a joint is commanded which is always where it is told to be."""
    found = []
    for step in range(1, steps + 1):
        run.advance(step * period)
        found.append(run.commands()[0])
        run.fix("state", [found[-1], 0.0])
    return np.array(found)


def step_response(times):
    """A mass on a spring with a damper, at rest until a constant force acts: the closed form."""
    frequency = sqrt(STIFFNESS / MASS)
    decay, damped = DAMPING_RATIO * frequency, frequency * sqrt(1 - DAMPING_RATIO**2)
    return np.array(
        [
            FORCE / STIFFNESS * (1 - exp(-decay * t) * (cos(damped * t) + decay / damped * sin(damped * t)))
            for t in times
        ]
    )


def test_a_step_of_force_is_answered_as_by_a_mass_on_a_spring():
    found = follow(slider([FORCE, 0.0, 0.0, 0.0, 0.0, 0.0]), 2000)
    expected = step_response(np.arange(1, 2001) * 1e-3)
    assert expected.max() > 1.15 * FORCE / STIFFNESS  # it swings over
    np.testing.assert_allclose(found, expected, atol=0.01 * FORCE / STIFFNESS)
    assert found[-1] == pytest.approx(FORCE / STIFFNESS, rel=0.01)


def test_half_the_period_halves_the_error():
    errors = []
    for period, steps in ((4e-3, 100), (2e-3, 200)):
        found = follow(slider([FORCE, 0.0, 0.0, 0.0, 0.0, 0.0], period), steps, period)
        errors.append(np.abs(found - step_response(np.arange(1, steps + 1) * period)).max())
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("wrench", [[0.0, 9.0, 9.0, 9.0, 9.0, 9.0], [nan, 9.0, 0.0, 0.0, 0.0, 0.0]])
def test_forces_along_other_axes_and_unknown_ones_do_nothing(wrench):
    run = slider(wrench)
    run.advance(0.1)
    assert run.commands() == [0.0]


def test_a_force_along_an_axis_that_is_not_selected_does_nothing():
    axes = {**SLIDING["admittance"], "selected_axes": [False, True, True, True, True, True]}
    run = slider([FORCE, 0.0, 0.0, 0.0, 0.0, 0.0], admittance=axes)
    run.advance(0.1)
    assert run.commands() == [0.0]


def wrench_message(x, frame=""):
    force, torque = messages.Vector3(x, 0.0, 0.0), messages.Vector3(0.0, 0.0, 0.0)
    return messages.WrenchStamped(messages.header(0.0, frame), messages.Wrench(force, torque))


def test_a_wrench_reference_is_added_to_the_measured_wrench():
    run = slider([2.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    run.send("wrench_reference", wrench_message(3.0, "cart"))
    both = follow(run, 50)
    np.testing.assert_array_equal(both, follow(slider([5.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 50))


def test_a_wrench_in_another_frame_is_refused():
    with pytest.raises(CommandError, match="the wrench is in the frame 'tool', but the sensor's is 'cart'"):
        slider().send("wrench_reference", wrench_message(3.0, "tool"))


def point(positions=(), velocities=()):
    return messages.JointTrajectoryPoint(np.array(positions), np.array(velocities), np.zeros(0), np.zeros(0), None)


def test_a_reference_is_followed_and_its_missing_parts_stay():
    run = slider(command_interfaces=["position", "velocity"])
    run.send("joint_references", point([0.2], [0.3]))
    run.fix("state", [0.2, 0.0])
    run.advance(0.001)
    assert run.commands() == [0.2, 0.3]
    run.send("joint_references", point([], [0.5]))
    run.advance(0.002)
    assert run.commands() == [0.2, 0.5]
    run.send("joint_references", point([nan], [0.6]))
    run.advance(0.003)
    assert run.commands() == [0.2, 0.6]


def test_a_reference_of_another_size_is_refused():
    with pytest.raises(CommandError, match="the reference has 2 positions, but there are 1 joints: slide"):
        slider().send("joint_references", point([0.1, 0.2]))


def test_the_velocity_at_activation_is_the_first_reference_if_it_is_measured():
    run = arm(velocities=[0.1] * 6, state_interfaces=["position", "velocity"], command_interfaces=["velocity"])
    run.advance(0.01)
    assert run.controller.sample(run.context).memory.velocities == (0.1,) * 6
    assert arm(velocities=[0.1] * 6).controller is not None
    run = arm(velocities=[0.1] * 6)
    assert run.controller.sample(run.context).memory.velocities == (0.0,) * 6


def test_an_upstream_controllers_references_are_followed_and_messages_are_not():
    run = slider(upstream={"above": Upstream(2, (0, 1))}, command_interfaces=["position", "velocity"])
    run.send("joint_references", point([0.4], [0.4]))
    run.fix("above", [0.2, nan])
    run.fix("state", [0.2, 0.0])
    run.advance(0.001)
    assert run.commands() == [0.2, 0.0]
    run.fix("above", [nan, nan])
    run.fix("state", [0.4, 0.0])
    run.advance(0.002)
    assert run.commands() == [0.4, 0.4]


def test_an_activation_starts_without_an_offset():
    run = slider([FORCE, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert follow(run, 100)[-1] > 0.01
    run.controller.deactivate(run.context)
    run.fix("state", [0.7, 0.0])
    run.controller.activate(run.context)
    memory = run.controller.sample(run.context).memory
    assert (memory.positions, memory.state.joint_positions) == ((0.7,), (0.0,))


def test_accelerations_are_left_out_and_it_is_said():
    run = arm(command_interfaces=["position", "acceleration"])
    assert len(run.commands()) == 6
    assert run.controller.warnings == (
        "the twin neither measures nor commands accelerations: these interfaces are left out",
    )


@pytest.mark.parametrize(
    ("path", "value", "text"),
    [
        ("kinematics.tip", "hand", "the robot has no link 'hand' (it has base_link, link_1,"),
        (
            "kinematics.tip",
            "link_5",
            "those between base_link and link_5 are joint1, joint2, joint3, joint4, joint5",
        ),
        ("joints", ["joint2"], "joints are joint2, but those between base_link and tool0 are joint1, joint2,"),
        ("ft_sensor.name", "fts", "the robot has no force_torque sensor 'fts' for Gazebo"),
    ],
)
def test_a_robot_without_the_chain_or_the_sensor_is_said(path, value, text):
    assert AdmittanceController.problem(parameters_of(KIND, **ADMITTANCE), ARM) is None
    assert text in AdmittanceController.problem(parameters_of(KIND, **changed(ADMITTANCE, path, value)), ARM)


def test_a_frame_that_another_joint_moves_is_said():
    robot = replace(ARM, links=(*ARM.links, "lid"), joints=(*ARM.joints, Joint("hinge", "revolute", "tool0", "lid")))
    given = changed(ADMITTANCE, "control.frame.id", "lid")
    problem = AdmittanceController.problem(parameters_of(KIND, **given), robot)
    assert problem == "the link 'lid' is moved by hinge, which is not between base_link and tool0"


RAIL = """<robot name="rail">
  <link name="world"/>
  <link name="base"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="cart"><inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="stand" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1000" velocity="10"/></joint>
  <ros2_control name="s" type="system">
    <hardware><plugin>mock_components/GenericSystem</plugin></hardware>
    <joint name="slide"><command_interface name="position"/><state_interface name="position"/></joint>
    <sensor name="fts"><state_interface name="force.x"/></sensor>
  </ros2_control>
</robot>"""


def rail(tmp_path, *, chained=False):
    file = tmp_path / "rail.urdf"
    file.write_text(RAIL)
    builder = TwinBuilder().robot("rail", file)
    builder = builder.controller(
        "rail", "admittance", KIND, changed(SLIDING, "admittance.damping_ratio", [2.828427] * 6)
    )
    if chained:
        given = {"joints": ["admittance/slide"], "interface_name": "position"}
        builder = builder.controller("rail", "above", "forward_command_controller/ForwardCommandController", given)
    return builder.build()


def test_in_a_twin_a_wrench_moves_the_joint_as_far_as_the_spring_lets_it(tmp_path):
    twin = rail(tmp_path)
    twin.publish("/rail/admittance/wrench_reference", {"wrench": {"force": {"x": FORCE}}})
    twin.advance_to(6.0)
    assert twin.latest("/rail/joint_states").position[0] == pytest.approx(FORCE / STIFFNESS, rel=0.01)
    assert twin.latest("/rail/admittance/status").wrench_base.wrench.force.x == FORCE


def test_in_a_twin_another_controller_writes_its_references(tmp_path):
    twin = rail(tmp_path, chained=True)
    twin.publish("/rail/above/commands", [0.3])
    twin.publish("/rail/admittance/wrench_reference", {"wrench": {"force": {"x": FORCE}}})
    twin.advance_to(6.0)
    assert twin.latest("/rail/joint_states").position[0] == pytest.approx(0.3 + FORCE / STIFFNESS, rel=0.01)


def test_in_a_twin_a_saved_run_goes_on_as_it_did_the_first_time(tmp_path):
    twin = rail(tmp_path, chained=True)
    twin.publish("/rail/above/commands", [0.3])
    twin.publish("/rail/admittance/wrench_reference", {"wrench": {"force": {"x": FORCE}}})
    twin.publish("/rail/admittance/joint_references", {"positions": [0.1]})
    twin.advance_to(0.2)
    twin.snapshot().save(tmp_path / "state.json")
    twin.advance_to(0.4)
    first = twin.latest("/rail/joint_states").position[0]
    assert first > 0.05
    again = rail(tmp_path, chained=True)
    again.restore(Snapshot.load(tmp_path / "state.json"))
    again.advance_to(0.4)
    assert again.latest("/rail/joint_states").position[0] == first
