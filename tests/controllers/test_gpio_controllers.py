"""Hold against ros2_controllers' test_gpio_command_controller.cpp, cited as "gtest: line"."""

from types import SimpleNamespace

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from drake_twin import TwinBuilder, messages
from drake_twin.check import check
from drake_twin.cockpit.joint_commands import JointCommands
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.gpio_controllers import GpioCommandController, GpioCommandParameters
from drake_twin.controllers.interface import Interface
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.diagram.gpios import add_gpios
from drake_twin.errors import CommandError, InputError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.systems.no_message import make_value

PERIOD = 0.01
WITHOUT_GPIO = "<robot name='r'><link name='base'/></robot>"
# As the fixture's interfaces and their values (gtest: 111).
GPIOS = """<robot name="r"><link name="base"/><ros2_control name="s" type="system">
  <gpio name="gpio1">
    <command_interface name="dig.1"><param name="initial_value">1.0</param></command_interface>
    <command_interface name="dig.2"><param name="initial_value">0.0</param></command_interface>
    <state_interface name="dig.1"><param name="initial_value">1.0</param></state_interface>
    <state_interface name="dig.2"><param name="initial_value">0.0</param></state_interface>
  </gpio>
  <gpio name="gpio2">
    <command_interface name="ana.1"><param name="initial_value">3.1</param></command_interface>
    <state_interface name="ana.1"><param name="initial_value">3.1</param></state_interface>
  </gpio>
</ros2_control></robot>"""
ONE_STATE = """<robot name="r"><link name="base"/><ros2_control name="TestSystemHardware" type="system">
  <gpio name="gpio1"><command_interface name="dig.1"/>
    <state_interface name="dig.1"><param name="initial_value">1.0</param></state_interface></gpio>
</ros2_control></robot>"""
BOTH = {"gpio1": {"interfaces": ["dig.1", "dig.2"]}, "gpio2": {"interfaces": ["ana.1"]}}
ALL = {"gpios": ["gpio1", "gpio2"], "command_interfaces": BOTH, "state_interfaces": BOTH}
NONE = {
    "gpios": ["gpio1"],
    "command_interfaces": {"gpio1": {"interfaces": []}},
    "state_interfaces": {"gpio1": {"interfaces": []}},
}


def init(parameters):
    """Read the parameters, as upstream's on_init."""
    given = ControllerParameters("test_gpio_command_controller", "gpio_controllers/GpioCommandController", parameters)
    return read_parameters(GpioCommandParameters, given)[0]


def describe(text):
    return describe_urdf(XmlReader(text), text)


def problem(parameters, text):
    return GpioCommandController.problem(init(parameters), describe(text))


class Harness:
    """A controller and the hardware of its GPIOs."""

    def __init__(self, parameters=ALL, text=GPIOS):
        parameters, description = init(parameters), describe(text)
        assert GpioCommandController.problem(parameters, description) is None
        claims = GpioCommandController.claimed_interfaces(parameters, description)
        setup = ControllerSetup("dut", parameters, claims, description, StateLayout(0, {}, {}, {}))
        builder = DiagramBuilder()
        self.dut = builder.AddNamedSystem("dut", GpioCommandController(setup))
        plan = SimpleNamespace(description=description, manager=SimpleNamespace(update_rate=1 / PERIOD))
        self.hardware = add_gpios(builder, plan, {"dut": self.dut}, PERIOD)
        self.simulator = Simulator(builder.Build())
        context = self.simulator.get_mutable_context()
        self.context = self.dut.GetMyMutableContextFromRoot(context)
        self.hardware_context = self.hardware.GetMyContextFromRoot(context)
        self.updates = 0

    def publish(self, command):
        message = messages.message("control_msgs/msg/DynamicInterfaceGroupValues", command)
        value = self.dut.read("commands", message, self.context)
        self.dut.get_commands_input_port().FixValue(self.context, make_value(value))

    def update(self):
        self.simulator.AdvanceTo((self.updates + 0.5) * PERIOD)
        self.updates += 1

    def commands(self):
        return self.hardware.commands(self.hardware_context).tolist()

    def states(self):
        return self.dut.get_gpio_states_output_port().Eval(self.context)


def command(**groups):
    return {
        "interface_groups": [*groups],
        "interface_values": [{"interface_names": names, "values": values} for names, values in groups.values()],
    }


def test_parameters_that_upstream_refuses_are_refused():
    with pytest.raises(InputError, match="the parameter 'gpios' is missing"):  # gtest: 255
        init({})
    with pytest.raises(InputError, match="the list is empty"):  # gtest: 264
        init({"gpios": []})
    for parameters in (
        {"gpios": ["gpio1", "gpio1"]},
        {"gpios": ["gpio1"], "command_interfaces": {"gpio1": {"interfaces": ["a", "a"]}}},
    ):  # unique<> of gpio_command_controller_parameters.yaml
        with pytest.raises(InputError, match="duplicate"):
            init(parameters)


@pytest.mark.parametrize("parameters", [NONE, {"gpios": ["gpio1"]}, ALL])  # gtest: 275, 284, 299
def test_interfaces_may_be_empty_or_left_out(parameters):
    assert init(parameters).gpios == tuple(parameters["gpios"])


def test_interfaces_may_be_written_as_in_the_documentation():
    """gpio_controllers/doc/userdoc.rst and example_10 of ros2_control_demos have a list of one mapping."""
    written = {"gpios": ["gpio1"], "command_interfaces": {"gpio1": [{"interfaces": ["dig.1", "dig.2"]}]}}
    assert [str(item) for item in init(written).commands()] == ["gpio1/dig.1", "gpio1/dig.2"]


def test_a_controller_without_any_interface_cannot_be_configured():
    assert "no command or state interface is configured" in problem(NONE, WITHOUT_GPIO)  # gtest: 314, 345
    assert problem(NONE, ONE_STATE) is None  # gtest: 330


def test_a_controller_whose_interfaces_are_there_can_be_activated():
    assert problem(ALL, GPIOS) is None  # gtest: 358, by 145 and 149
    fewer_states = {"gpio1": {"interfaces": ["dig.1"]}, "gpio2": {"interfaces": ["ana.1"]}}
    assert problem(ALL | {"state_interfaces": fewer_states}, GPIOS) is None  # gtest: 430


def test_a_missing_interface_is_named_and_prevents_the_activation():
    no_command = GPIOS.replace('<command_interface name="ana.1">', '<command_interface name="ana.2">')
    assert problem(ALL, no_command) == (  # gtest: 386
        "gpio gpio2 has no ana.1 command interface in <ros2_control> (it has ana.2)"
    )
    no_state = GPIOS.replace('<state_interface name="ana.1">', '<state_interface name="ana.2">')
    assert problem(ALL, no_state) == (  # gtest: 416
        "gpio gpio2 has no ana.1 state interface in <ros2_control> (it has ana.2)"
    )
    assert problem(ALL, ONE_STATE.replace("dig.1", "dig.2")).startswith("gpio gpio1 has no dig.1 command interface")
    assert problem(ALL, WITHOUT_GPIO) == "the robot has no gpio 'gpio1' in <ros2_control> (it has none)"


def test_nothing_is_written_before_the_first_command():
    harness = Harness()
    assert harness.commands() == [1.0, 0.0, 3.1]  # gtest: 160
    harness.update()
    assert harness.commands() == [1.0, 0.0, 3.1]  # gtest: 160
    assert [value.values.tolist() for value in harness.states().interface_values] == [[1.0, 0.0], [3.1]]  # gtest: 163


@pytest.mark.parametrize("values", [[0.0, 1.0, 1.0], [0.0]])  # gtest: 466, 487
def test_names_that_do_not_match_values_deactivate_the_controller(values):
    harness = Harness()
    with pytest.raises(CommandError, match=f"gpio1 the command has 2 interface_names, but {len(values)} val") as error:
        harness.publish(command(gpio1=(["dig.1", "dig.2"], values), gpio2=(["ana.1"], [30.0])))
    assert error.value.deactivates


@pytest.mark.parametrize(
    ("groups", "expected"),
    [
        ({"gpio1": (["dig.1", "dig.2"], [0.0, 1.0]), "gpio2": (["ana.1"], [30.0])}, [0.0, 1.0, 30.0]),  # gtest: 510
        ({"gpio2": (["ana.1"], [30.0]), "gpio1": (["dig.2", "dig.1"], [1.0, 0.0])}, [0.0, 1.0, 30.0]),  # gtest: 533
        ({"gpio1": (["dig.1", "dig.2"], [0.0, 1.0])}, [0.0, 1.0, 3.1]),  # gtest: 555
    ],
)
def test_a_command_is_written_by_name(groups, expected):
    harness = Harness()
    harness.publish(command(**groups))
    harness.update()
    assert harness.commands() == expected


def test_a_command_to_interfaces_that_are_not_the_controllers_writes_nothing():
    harness = Harness()
    with pytest.raises(CommandError, match=r"gpio1/dig.3 is not a command interface .*: gpio1/dig.1, gpio1/dig.2, g"):
        harness.publish(command(gpio1=(["dig.3", "dig.4"], [20.0, 25.0]), gpio3=(["ana.1"], [21.0])))
    harness.update()
    assert harness.commands() == [1.0, 0.0, 3.1]  # gtest: 578


def test_a_command_that_is_infinite_or_lacks_values_is_dropped():
    harness = Harness()
    with pytest.raises(CommandError, match=r"for gpio2/ana.1 is inf, which is not a finite number") as error:
        harness.publish(command(gpio2=(["ana.1"], [np.inf])))
    assert not error.value.deactivates
    with pytest.raises(CommandError, match="1 interface_groups, but 0 interface_values"):
        harness.publish({"interface_groups": ["gpio1"], "interface_values": []})


def test_states_are_published_by_gpio():
    harness = Harness()
    harness.update()
    message = harness.states()
    assert len(message.interface_groups) == 2  # gtest: 629
    assert message.interface_groups[0] == "gpio1"  # gtest: 630
    assert message.interface_groups[1] == "gpio2"  # gtest: 631
    assert message.interface_values[0].interface_names[0] == "dig.1"  # gtest: 632
    assert message.interface_values[0].interface_names[1] == "dig.2"  # gtest: 633
    assert message.interface_values[1].interface_names[0] == "ana.1"  # gtest: 634
    assert message.interface_values[0].values[0] == 1.0  # gtest: 635
    assert message.interface_values[0].values[1] == 0.0  # gtest: 636
    assert message.interface_values[1].values[0] == 3.1  # gtest: 637


def test_without_state_interfaces_all_those_of_ros2_control_are_published():
    harness = Harness({"gpios": ["gpio1"], "command_interfaces": {"gpio1": {"interfaces": ["dig.1"]}}}, ONE_STATE)
    harness.update()
    message = harness.states()
    assert len(message.interface_groups) == 1  # gtest: 676
    assert message.interface_groups[0] == "gpio1"  # gtest: 677
    assert message.interface_values[0].interface_names[0] == "dig.1"  # gtest: 678
    assert message.interface_values[0].values[0] == 1.0  # gtest: 679


def test_without_command_interfaces_the_controller_only_publishes():
    states = {"gpio1": {"interfaces": ["dig.1"]}, "gpio2": {"interfaces": ["ana.1"]}}
    harness = Harness({"gpios": ["gpio1", "gpio2"], "state_interfaces": states})
    assert not harness.dut.subscribed
    harness.update()
    message = harness.states()
    assert len(message.interface_groups) == 2  # gtest: 713
    assert message.interface_groups[0] == "gpio1"  # gtest: 714
    assert message.interface_groups[1] == "gpio2"  # gtest: 715
    assert message.interface_values[0].interface_names == ["dig.1"]  # gtest: 716
    assert message.interface_values[1].interface_names == ["ana.1"]  # gtest: 717
    assert message.interface_values[0].values.tolist() == [1.0]  # gtest: 718
    assert message.interface_values[1].values.tolist() == [3.1]  # gtest: 719


def test_a_gpio_without_listed_states_is_published_without_values():
    harness = Harness(ALL | {"state_interfaces": {"gpio2": {"interfaces": ["ana.1"]}}})
    assert [value.interface_names for value in harness.states().interface_values] == [[], ["ana.1"]]


def test_interfaces_of_another_gpio_are_a_warning():
    harness = Harness({"gpios": ["gpio1"], "command_interfaces": BOTH})
    assert harness.dut.warnings == ("command_interfaces.gpio2 is ignored: 'gpio2' is not among the gpios",)
    assert [str(claim) for claim in harness.dut.claims] == ["gpio1/dig.1", "gpio1/dig.2"]


ROBOT = """<robot name="r">
<link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link>
<ros2_control name="s" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>
  <gpio name="vacuum">
    <command_interface name="valve"/><state_interface name="valve"/><state_interface name="pressure"/>
  </gpio>
  <gpio name="lamp"><command_interface name="on" data_type="bool"/><state_interface name="on" data_type="bool"/></gpio>
</ros2_control></robot>"""
YAML = """
controller_manager:
  ros__parameters:
    io: {type: gpio_controllers/GpioCommandController}
    lamps: {type: forward_command_controller/ForwardCommandController}
io:
  ros__parameters: {gpios: [vacuum, lamp], command_interfaces: {vacuum: {interfaces: [valve]}}}
lamps:
  ros__parameters: {joints: [lamp], interface_name: "on"}
"""


@pytest.fixture
def twin(tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "c.yaml").write_text(YAML)
    return TwinBuilder().robot("r", tmp_path / "r.urdf", xyz=(0, 0, 0.5), controllers=tmp_path / "c.yaml").build()


def published(twin):
    message = twin.latest("/r/io/gpio_states")
    return [value.values.tolist() for value in message.interface_values]


def test_a_twin_has_the_gpios_of_its_robots(twin):
    assert not twin.findings
    commands, states = twin.control.manager("r").list_hardware_interfaces()
    assert [(item.name, item.is_claimed) for item in commands] == [("vacuum/valve", True), ("lamp/on", True)]
    assert [item.name for item in states] == ["vacuum/valve", "vacuum/pressure", "lamp/on"]
    (component,) = twin.control.manager("r").list_hardware_components()
    assert component.command_interfaces == ("vacuum/valve", "lamp/on")
    assert component.state_interfaces == ("vacuum/valve", "vacuum/pressure", "lamp/on")


def test_a_gpio_has_no_limits_and_no_slider(twin):
    assert twin.graph.command_limits("/r/lamps/commands") == {Interface("lamp", "on"): (-np.inf, np.inf)}
    assert JointCommands(twin).groups == {}


def test_the_report_on_a_file_lists_its_gpios(tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT)
    report = check(str(tmp_path / "r.urdf"), {})
    assert report.robot["command_interfaces"] == {"vacuum": ["valve"], "lamp": ["on"]}
    assert report.robot["state_interfaces"] == {"vacuum": ["valve", "pressure"], "lamp": ["on"]}
    assert not report.findings


def test_a_twins_gpios_follow_commands_which_hold_and_are_saved(twin):
    twin.publish("/r/io/commands", command(vacuum=(["valve"], [0.25])))
    twin.publish("/r/lamps/commands", [1.0])
    twin.advance_to(0.05)
    np.testing.assert_equal(published(twin), [[0.25, np.nan], [1.0]])
    before = twin.snapshot()
    manager = twin.control.manager("r")
    manager.switch_controller(deactivate=["lamps"])
    manager.switch_controller(deactivate=["io"])
    twin.advance_to(0.1)
    manager.switch_controller(["io"])
    np.testing.assert_equal(published(twin), [[0.25, np.nan], [1.0]])
    twin.publish("/r/io/commands", command(vacuum=(["valve"], [0.5])))
    twin.advance_to(0.15)
    np.testing.assert_equal(published(twin), [[0.5, np.nan], [1.0]])
    twin.restore(before)
    np.testing.assert_equal(published(twin), [[0.25, np.nan], [1.0]])
    assert twin.snapshot() == before
    twin.reset()
    np.testing.assert_equal(published(twin), [[np.nan, np.nan], [0.0]])


def test_a_controller_of_a_missing_gpio_is_not_started_and_said_with_its_line(tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT.replace('"vacuum"', '"suction"'))
    (tmp_path / "c.yaml").write_text(YAML)
    twin = TwinBuilder().robot("r", tmp_path / "r.urdf", xyz=(0, 0, 0.5), controllers=tmp_path / "c.yaml").build()
    (finding,) = twin.findings
    assert "controller io: the robot has no gpio 'vacuum' in <ros2_control> (it has suction, lamp)" in str(finding)
    assert finding.file == str(tmp_path / "c.yaml")
