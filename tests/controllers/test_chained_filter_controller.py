"""Hold against ros2_controllers' test_chained_filter.cpp ("gtest: line"), test_multiple_chained_filter.cpp ("many")."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from drake_twin import TwinBuilder
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.chained_filter_controller import ChainedFilter, ChainedFilterParameters
from drake_twin.description.controllers_yaml import ControllerParameters
from drake_twin.description.parameters import read_parameters
from drake_twin.description.urdf import describe_urdf
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.kinematics.state_layout import StateLayout

PERIOD = 0.1
ROBOT = """<robot name="r">
<link name="base"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link>{}
<ros2_control name="s" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>
  <joint name="wheel_left"><command_interface name="effort"/><state_interface name="position"/>
    <state_interface name="velocity"/><state_interface name="effort"/></joint>
  <joint name="wheel_right"><command_interface name="velocity"/><state_interface name="position"/></joint>
  <gpio name="tank"><command_interface name="level"/>
    <state_interface name="level"><param name="initial_value">4.0</param></state_interface></gpio>
</ros2_control></robot>""".format(
    "".join(
        f'<link name="{side}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        f'</inertial></link><joint name="wheel_{side}" type="continuous"><parent link="base"/><child link="{side}"/>'
        f'<origin xyz="0 {y} 1"/><axis xyz="0 1 0"/></joint>'
        for side, y in (("left", 1), ("right", -1))
    )
)
DESCRIPTION = describe_urdf(XmlReader(ROBOT), ROBOT)


def mean(name, count):
    params = {"number_of_observations": count}
    return {"filter1": {"name": name, "type": "filters/MeanFilterDouble", "params": params}}


# The files in test/config.
ONE = {
    "filter_chain": mean("filter1", 2),
    "input_interfaces": ["wheel_left/position"],
    "output_interfaces": ["wheel_left/filtered_position"],
}
MANY = {
    "filter_chain": mean("position_filter", 2),
    "input_interfaces": ["wheel_left/position", "wheel_right/position"],
    "output_interfaces": ["wheel_left/filtered_position", "wheel_right/filtered_position"],
}
PER_INPUT = {name: MANY[name] for name in ("input_interfaces", "output_interfaces")} | {
    "wheel_left/position": {"filter_chain": mean("wheel_left_filter", 2)},
    "wheel_right/position": {"filter_chain": mean("wheel_right_filter", 3)},
}


def init(parameters):
    kind = "chained_filter_controller/ChainedFilter"
    return read_parameters(ChainedFilterParameters, ControllerParameters("dut", kind, parameters))[0]


class Harness:
    """A controller of a robot whose state is set by hand."""

    def __init__(self, parameters, left=1.1, right=2.2):
        parameters = init(parameters)
        layout = StateLayout(
            4,
            {"wheel_left": 0, "wheel_right": 1},
            {"wheel_left": 2, "wheel_right": 3},
            {"wheel_left": 1},
            num_actuators=2,
        )
        assert ChainedFilter.problem(parameters, DESCRIPTION) is None
        self.dut = ChainedFilter(ControllerSetup("dut", parameters, (), DESCRIPTION, layout, PERIOD))
        self.simulator = Simulator(self.dut)
        self.context = self.simulator.get_mutable_context()
        self.set(left, right)
        for name, values in (("net_actuation", [9.0, 7.0]), ("gpio_states", [4.0])):
            if name in self.dut.robot_inputs:
                self.dut.robot_inputs[name].FixValue(self.context, values)
        self.dut.activate(self.context)
        self.updates = 0

    def set(self, left, right=0.0, speed=0.0):
        self.dut.get_state_input_port().FixValue(self.context, [left, right, speed, 0.0])

    def update(self):
        self.simulator.AdvanceTo((self.updates + 0.5) * PERIOD)
        self.updates += 1
        assert self.dut.fault(self.context) is None
        return self.dut.get_state_interfaces_output_port().Eval(self.context).tolist()


def test_parameters_that_upstream_refuses_are_refused():
    with pytest.raises(InputError, match="the parameter 'input_interfaces' is missing"):  # gtest: 80
        init({})
    with pytest.raises(InputError, match="there are 1 input_interfaces, but 2 output_interfaces"):  # gtest: 92
        init(ONE | {"output_interfaces": ["wheel_left/filtered_position", "extra_interface"]})


def test_the_exported_interfaces_are_those_of_upstream():
    assert init(ONE).input_interfaces == ("wheel_left/position",)  # gtest: 113
    assert Harness(ONE).dut.claims == ()  # gtest: 116
    exported = ChainedFilter.exported_interfaces(init(ONE))
    assert len(exported) == 1  # gtest: 120
    assert exported[0] == "wheel_left/filtered_position"  # gtest: 121, without the controller's name
    left, right = ChainedFilter.exported_interfaces(init(MANY))  # many: 102
    assert left == "wheel_left/filtered_position"  # many: 103
    assert right == "wheel_right/filtered_position"  # many: 111


def test_a_single_interface_is_filtered():
    harness = Harness(ONE)
    assert harness.update() == [1.1]  # gtest: 142
    harness.set(2.0)
    assert harness.update() == [1.55]  # gtest: 150
    assert harness.update() == [2.0]  # gtest: 155


def test_one_chain_filters_several_interfaces():
    harness = Harness(MANY)
    assert harness.update() == [1.1, 2.2]  # many: 136, 137
    harness.set(2.0, 3.0)
    assert harness.update() == [1.55, 2.6]  # many: 146, 148
    assert harness.update() == [2.0, 3.0]  # many: 154, 155


def test_each_interface_has_its_own_chain():
    harness = Harness(PER_INPUT)
    assert harness.update() == [1.1, 2.2]  # many: 174, 175
    harness.set(2.0, 2.8)
    assert harness.update() == [1.55, 2.5]  # many: 184, 187
    assert harness.update() == pytest.approx([2.0, 2.6], rel=4e-16)  # many: 193, 195
    assert harness.update() == pytest.approx([2.0, 2.8], abs=1e-5)  # many: 201, 203


def test_a_chain_filters_one_after_the_other_and_without_filters_passes_the_value():
    smooth = {"name": "smooth", "type": "control_filters/ExponentialFilterDouble", "params": {"alpha": 0.5}}
    harness = Harness(ONE | {"filter_chain": mean("mean", 2) | {"filter2": smooth}})
    assert harness.update() == [1.1]
    harness.set(2.1)
    assert harness.update() == pytest.approx([0.5 * 1.6 + 0.5 * 1.1])
    plain = Harness({name: ONE[name] for name in ("input_interfaces", "output_interfaces")})
    assert plain.update() == [1.1]


def test_a_single_interface_has_the_common_chain_only():
    own = {name: ONE[name] for name in ("input_interfaces", "output_interfaces")}
    harness = Harness(own | {"wheel_left/position": {"filter_chain": mean("a", 2)}})
    assert harness.dut.warnings == ("wheel_left/position.filter_chain is ignored: a single interface has filter_chain",)
    harness.update()
    harness.set(2.0)
    assert harness.update() == [2.0]


def test_velocities_efforts_and_gpios_are_filtered():
    names = ["wheel_left/velocity", "wheel_left/effort", "tank/level"]
    harness = Harness({"input_interfaces": names, "output_interfaces": ["a", "b", "c"]})
    harness.set(1.0, speed=3.0)
    assert harness.update() == [3.0, 7.0, 4.0]


def test_an_input_that_is_not_finite_changes_nothing():
    harness = Harness(ONE, left=np.nan)
    assert np.isnan(harness.update()).all()
    harness.set(1.0)
    assert harness.update() == [1.0]
    harness.set(np.inf)
    assert harness.update() == [1.0]
    harness.set(2.0)
    assert harness.update() == [1.5]


def test_filters_continue_when_the_controller_is_activated_again():
    harness = Harness(ONE, left=1.0)
    harness.update()
    harness.dut.deactivate(harness.context)
    harness.dut.activate(harness.context)
    assert np.isnan(harness.dut.get_state_interfaces_output_port().Eval(harness.context)).all()
    harness.set(2.0)
    assert harness.update() == [1.5]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"type": "filters/Nothing"}, "Valid: filters/MeanFilterDouble, control_filters/LowPassFilterDouble, control_"),
        ({"params": {}}, "the parameter 'number_of_observations' of a filters/MeanFilterDouble is missing"),
        ({"type": "control_filters/ExponentialFilterDouble", "params": {}}, "the parameter 'alpha' of a control_filt"),
        ({"params": {"number_of_observations": 0}}, "0 is below 1"),
        ({"type": "control_filters/ExponentialFilterDouble", "params": {"alpha": 1.5}}, "1.5 is above 1"),
        ({"type": "control_filters/ExponentialFilterDouble", "params": {"alpha": "a"}}, "'a' is not a number"),
        ({"type": "control_filters/RateLimiterDouble", "params": {}}, "parameter 'sampling_interval' of a"),
        ({"type": "control_filters/RateLimiterDouble", "params": {"sampling_interval": 0.0}}, "0.0 is not above 0"),
        ({"type": "control_filters/RateLimiterDouble", "params": {"min_value": 1.0}}, "1.0 is above 0"),
        (
            {"type": "control_filters/LowPassFilterDouble", "params": {"damping_frequency": 1.0}},
            "the parameter 'sampling_frequency' of a control_filters/LowPassFilterDouble is missing",
        ),
    ],
)
def test_a_wrong_filter_is_refused(change, message):
    chain = {"filter1": mean("filter1", 2)["filter1"] | change}
    with pytest.raises(InputError) as error:
        init(ONE | {"filter_chain": chain})
    assert message in str(error.value)


def test_a_filter_needs_a_name_of_its_own():
    with pytest.raises(InputError, match="two filters have the name 'a'"):
        init(ONE | {"filter_chain": mean("a", 2) | {"filter2": mean("a", 2)["filter1"]}})


def test_what_has_no_effect_is_said():
    extra = mean("a", 2) | {"filter3": mean("b", 2)["filter1"]}
    extra["filter1"]["params"]["alpha"] = 0.0
    parameters = ONE | {"filter_chain": extra, "wheel_left/position": {"filter_chain": mean("c", 2)}}
    assert Harness(parameters | {"wheel_up": {"filter_chain": {}}}).dut.warnings == (
        "wheel_left/position.filter_chain is ignored: filter_chain is for all",
        "wheel_up.filter_chain is ignored: it is not among the input_interfaces",
        "filter_chain.filter1.params.alpha is ignored: a filters/MeanFilterDouble has no such parameter",
        "filter_chain.filter3 is ignored: filters are filter1, filter2 and so on, without a gap",
    )


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "wheel_left/acceleration",
            "joint wheel_left has no state interface 'acceleration' (it has position, velocity",
        ),
        ("wheel_right/velocity", "joint wheel_right has no state interface 'velocity' (it has position)"),
        (
            "imu/orientation",
            "the state of 'imu' cannot be filtered, only a joint's or gpio's of <ros2_control>: wheel_l",
        ),
        ("tank/flow", "gpio tank has no flow state interface in <ros2_control> (it has level)"),
    ],
)
def test_a_missing_state_interface_is_named_and_prevents_the_activation(name, message):
    parameters = init(ONE | {"input_interfaces": [name]})
    assert message in ChainedFilter.problem(parameters, DESCRIPTION)


YAML = """
controller_manager: {ros__parameters: {dut: {type: chained_filter_controller/ChainedFilter}}}
dut:
  ros__parameters:
    input_interfaces: [wheel_left/position, tank/level, wheel_left/effort]
    output_interfaces: [wheel_left/filtered_position, level, effort]
    filter_chain:
      filter1: {name: a, type: filters/MeanFilterDouble, params: {number_of_observations: 2}}
"""


def test_a_twin_lists_the_filtered_interfaces_and_has_them_on_a_port(tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "c.yaml").write_text(YAML)
    builder = TwinBuilder().robot("r", tmp_path / "r.urdf", xyz=(0, 0, 0.5), controllers=tmp_path / "c.yaml")
    twin = builder.build()
    twin.advance_to(0.1)
    _, states = twin.control.manager("r").list_hardware_interfaces()
    assert [item.name for item in states][-3:] == ["dut/wheel_left/filtered_position", "dut/level", "dut/effort"]
    position, level, _ = twin.graph.evaluate(twin.diagram.GetOutputPort("r/dut/state_interfaces"))
    assert position == pytest.approx(twin.robot_state("r").positions[0], abs=1e-3)
    assert level == 4.0
    before = twin.snapshot()
    twin.advance_to(0.2)
    twin.restore(before)
    assert twin.snapshot() == before
