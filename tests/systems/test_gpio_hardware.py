"""Hold against ros2_control's mock_components/test_generic_system.cpp, cited as "gtest: line"."""

from math import isnan, nan

import pytest
from pydrake.systems.analysis import Simulator

from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.systems.gpio_hardware import GpioHardware, GpioState

ROBOT = """<robot name="r"><link name="base"/><ros2_control name="MockHardwareSystem" type="system">
<hardware><plugin>mock_components/GenericSystem</plugin>{}</hardware>
<gpio name="flange_analog_IOs">
  <command_interface name="analog_output1" data_type="double"/>
  <state_interface name="analog_output1"/>
  <state_interface name="analog_input1"/>
  <state_interface name="analog_input2"/>
</gpio>
<gpio name="flange_vacuum">
  <command_interface name="vacuum"{kind}/>
  <state_interface name="vacuum"{kind}/>
</gpio>
</ros2_control></robot>"""


def describe(text):
    return describe_urdf(XmlReader(text), text)


def gpios(hardware="", kind=""):
    return describe(ROBOT.format(hardware, kind=kind)).gpios


def test_the_interfaces_of_gpios_are_listed():
    analog, vacuum = gpios().values()
    assert [*analog.states] == ["analog_output1", "analog_input1", "analog_input2"]  # gtest: 1859, 1860, 1861
    assert [*vacuum.states] == ["vacuum"]  # gtest: 1862
    assert [*analog.commands] == ["analog_output1"]  # gtest: 1868
    assert [*vacuum.commands] == ["vacuum"]  # gtest: 1869


def test_an_interface_without_an_initial_value_starts_as_nan_or_false():
    values = gpios()
    assert isnan(values["flange_analog_IOs"].states["analog_output1"])  # gtest: 1886
    assert isnan(values["flange_vacuum"].states["vacuum"])  # gtest: 1887
    assert isnan(values["flange_analog_IOs"].commands["analog_output1"])  # gtest: 1888
    assert isnan(values["flange_vacuum"].commands["vacuum"])  # gtest: 1889
    as_bool = gpios(kind=' data_type="bool"')["flange_vacuum"]
    assert as_bool.states["vacuum"] == as_bool.commands["vacuum"] == 0.0  # gtest: 1994, 1995


def test_an_initial_value_is_read():
    text = """<robot name="r"><link name="base"/><ros2_control name="MockHardwareSystem" type="system">
    <gpio name="sample_io"><state_interface name="output_1"><param name="initial_value">1</param></state_interface>
    </gpio></ros2_control></robot>"""
    assert describe(text).gpios["sample_io"].states == {"output_1": 1.0}  # gtest: 2148


@pytest.mark.parametrize("flag", ["true", "True"])
def test_mock_gpio_commands_adds_a_command_to_each_state(flag):
    analog, vacuum = gpios(f'<param name="mock_gpio_commands">{flag}</param>').values()
    assert [*analog.commands] == ["analog_output1", "analog_input1", "analog_input2"]  # gtest: 1965, 1966, 1967
    assert [*vacuum.commands] == ["vacuum"]  # gtest: 1968
    assert all(map(isnan, analog.commands.values()))  # gtest: 2002, 2003, 2004


class Hardware:
    """Two outputs whose states follow, an input, and a controller's port."""

    def __init__(self):
        states = [GpioState(command=0), GpioState(initial_value=7.0), GpioState(command=1)]
        self.system = GpioHardware([nan, nan], states, {"controller": [0, -1, 1]}, period=1.0)
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self.time = -0.5
        self.write(nan, nan)

    def write(self, first, second):
        self.system.get_controller_input_port("controller").FixValue(self.context, [first, 99.0, second])

    def update(self):
        self.time += 1.0
        self.simulator.AdvanceTo(self.time)

    def commands(self):
        return self.system.commands(self.context).tolist()

    def states(self):
        return self.system.get_gpio_states_output_port().Eval(self.context).tolist()


def test_a_state_follows_its_command_one_update_later():
    hardware = Hardware()
    hardware.write(0.111, 0.222)
    hardware.update()
    assert [isnan(value) for value in hardware.states()] == [True, False, True]  # gtest: 1896, 1897
    assert hardware.commands() == [0.111, 0.222]  # gtest: 1898, 1899
    hardware.write(0.333, 0.444)
    hardware.update()
    assert hardware.states() == [0.111, 7.0, 0.222]  # gtest: 1910, 1911 and 1920, 1921
    assert hardware.commands() == [0.333, 0.444]  # gtest: 1922, 1923
    hardware.update()
    assert hardware.states() == [0.333, 7.0, 0.444]


@pytest.mark.parametrize("nothing", [nan, float("inf")])
def test_a_command_holds_until_a_finite_one_is_written(nothing):
    hardware = Hardware()
    hardware.write(0.5, 0.25)
    hardware.update()
    hardware.write(nothing, 0.75)
    hardware.update()
    hardware.update()
    assert hardware.commands() == [0.5, 0.75]
    assert hardware.states() == [0.5, 7.0, 0.75]


def test_values_are_restored_and_their_number_is_checked():
    hardware = Hardware()
    hardware.system.set_values(hardware.context, [1.0, 2.0, 3.0, 4.0, 5.0])
    assert hardware.system.values(hardware.context).tolist() == [1.0, 2.0, 3.0, 4.0, 5.0]
    assert (hardware.commands(), hardware.states()) == ([1.0, 2.0], [3.0, 4.0, 5.0])
    with pytest.raises(ValueError, match="there are 5 values of GPIOs"):
        hardware.system.set_values(hardware.context, [1.0])
