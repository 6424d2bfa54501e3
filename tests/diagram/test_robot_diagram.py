import numpy as np
import pytest
from conftest import ARM

from drake_twin import TwinBuilder
from drake_twin.findings import most_telling
from drake_twin.scenario import World


@pytest.mark.parametrize(("step", "rate"), [(0.001, 100), (0.005, 40), (0.005, 20), (0.003, 30), (0.0007, 50)])
def test_no_update_comes_behind_the_step_that_it_belongs_to(step, rate, tmp_path):
    """It would act a step later, where rounding has it so: with 5 ms and 40 Hz at one update in six."""
    (tmp_path / "c.yaml").write_text(
        f"controller_manager: {{ros__parameters: {{update_rate: {rate},"
        " c: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "c: {ros__parameters: {joints: [joint_1], command_interfaces: [position], state_interfaces: [position]}}\n"
    )
    twin = TwinBuilder(time_step=step).robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    period = twin.diagram.GetSubsystemByName("arm").GetSubsystemByName("c").setup.update_period
    steps = round(period / step)
    assert steps >= 1 / rate / step - 1e-6
    ticks = np.arange(1, 200_000)
    updates, of_plant = ticks * period, (ticks * steps) * step
    assert (updates <= of_plant).all()
    assert np.allclose(updates, of_plant, rtol=1e-15)


@pytest.mark.parametrize(
    ("rate", "own", "expected"),
    [
        (250, "", ["states, controller slow, the controller manager: the update rate of 250 Hz"]),
        (100, "update_rate: 400, ", ["slow: the update rate of 400 Hz"]),
        (100, "", []),
    ],
)
def test_rates_beyond_the_physics_are_said_of_broadcasters_and_the_manager_too(rate, own, expected, tmp_path):
    (tmp_path / "c.yaml").write_text(
        f"controller_manager: {{ros__parameters: {{update_rate: {rate}, "
        "states: {type: joint_state_broadcaster/JointStateBroadcaster},"
        " slow: {type: velocity_controllers/JointGroupVelocityController}}}\n"
        f"slow: {{ros__parameters: {{{own}joints: [joint_1]}}}}\n"
    )
    twin = TwinBuilder(time_step=0.01).robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    assert [text for text in twin.findings.warnings if "Hz" in text] == [
        f"arm: controller {text} is higher than that of the physics, which steps every 0.01 s: reduced to 100 Hz"
        for text in expected
    ]


FALLING = (
    '<robot name="ball"><link name="ball"><inertial><mass value="1"/>'
    '<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
)


@pytest.mark.parametrize(("step", "rate"), [(0.001, 100), (0.005, 40), (0.005, 20), (0.003, 30)])
def test_goals_that_end_at_any_update_leave_no_step_out_and_make_none_twice(step, rate, tmp_path):
    """The twin stops to look at each end; what falls besides has fallen for the whole time."""
    (tmp_path / "ball.urdf").write_text(FALLING)
    (tmp_path / "c.yaml").write_text(
        f"controller_manager: {{ros__parameters: {{update_rate: {rate},"
        " c: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "c: {ros__parameters: {joints: [joint_1], command_interfaces: [position], state_interfaces: [position]}}\n"
    )
    builder = TwinBuilder(time_step=step, world=World(ground=False)).robot(
        "ball", tmp_path / "ball.urdf", xyz=(5, 0, 0)
    )
    twin = builder.robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    ends = []

    def again(goal):
        ends.append(twin.time)
        points = [{"positions": [0.0], "time_from_start": 0.9 / rate}]
        goal = {"trajectory": {"joint_names": ["joint_1"], "points": points}}
        twin.graph.send_goal("/arm/c/follow_joint_trajectory", goal, again)

    again(None)
    twin.advance_to(600 * step)
    assert len(ends) > 10
    velocity = twin.entities.state("ball").linear[2]
    assert velocity == pytest.approx(-9.81 * twin.time, rel=1e-9)


def test_a_callback_of_a_result_that_is_refused_ends_nothing_but_itself(tmp_path, caplog):
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {c: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        "c: {ros__parameters: {joints: [joint_1], command_interfaces: [position], state_interfaces: [position]}}\n"
    )
    twin = TwinBuilder().robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    points = [{"positions": [0.1], "time_from_start": 0.1}]
    goal = {"trajectory": {"joint_names": ["joint_1"], "points": points}}
    twin.graph.send_goal("/arm/c/follow_joint_trajectory", goal, lambda goal: twin.reset())
    twin.advance_to(0.5)
    assert twin.time == 0.5
    assert "the callback of the goal for c: a callback cannot reset" in caplog.text


def test_an_attribute_of_a_link_that_nobody_reads_is_told_once(tmp_path):
    """Drake's parser would say it, too, without its file."""
    file = tmp_path / "block.urdf"
    file.write_text(
        '<robot name="block"><link name="world"/><link name="base" type="rigid"/>'
        '<joint name="j" type="fixed"><parent link="world"/><child link="base"/></joint></robot>'
    )
    twin = TwinBuilder().robot("block", file).build()
    assert [str(finding) for finding in twin.findings] == ["block: the attribute type of <link> (block.urdf:1)"]


def test_an_unknown_parameter_of_several_controllers_is_one_line(tmp_path):
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {one: {type: joint_state_broadcaster/JointStateBroadcaster},"
        " other: {type: joint_state_broadcaster/JointStateBroadcaster}}}\n"
        "one: {ros__parameters: {speed: 1}}\n"
        "other: {ros__parameters: {speed: 2}}\n"
    )
    twin = TwinBuilder().robot("arm", ARM, controllers=tmp_path / "c.yaml").build()
    what = "warning: arm: controller one, controller other: unknown parameter 'speed': it is ignored (c.yaml:2, 3)"
    assert most_telling(twin.findings) == [what]


WHEEL = """<robot name="r"><link name="world"/><link name="base"/><link name="wheel"><inertial><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="fix" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="j" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 0 1"/>
  <limit effort="50" velocity="9"/></joint><ros2_control name="s" type="system"><hardware>
  <plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware><joint name="j"><command_interface name="velocity"/>
  </joint></ros2_control></robot>"""


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_a_commanded_velocity_is_the_joints_in_each_engine(tmp_path, engine):
    (tmp_path / "r.urdf").write_text(WHEEL)
    twin = TwinBuilder(engine=engine).robot("r", tmp_path / "r.urdf").build()
    twin.publish("/r/forward_velocity_controller/commands", [1.5])
    twin.advance_to(0.5)
    before = twin.robot_state("r").positions[0]
    twin.advance_to(0.7)
    assert twin.robot_state("r").velocities[0] == pytest.approx(1.5, rel=1e-3)
    assert twin.robot_state("r").positions[0] - before == pytest.approx(0.3, rel=1e-3)


WHEEL = """<robot name="wheel"><link name="world"/><link name="rim"><inertial><mass value="1"/>
<inertia ixx="0.5" iyy="0.5" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="axle" type="continuous"><parent link="world"/><child link="rim"/><axis xyz="0 0 1"/>{limit}</joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="axle"><command_interface name="effort"/><state_interface name="velocity"/></joint></ros2_control>
</robot>"""


@pytest.mark.parametrize(
    ("limit", "change", "fastest"),
    [
        ("", 1.0, 4.0),
        ('<limit effort="9" velocity="90"/>', 1.0, 4.0),
        ('<limit effort="9" velocity="3"/>', 1.0, 3.0),
        ('<dynamics friction="0.5"/>', 0.75, 3.0),
    ],
)
def test_an_effort_speeds_a_joint_up_to_its_velocity_limit_if_it_has_one(limit, change, fastest, tmp_path):
    """A torque of 2 N·m on 0.5 kg·m² is 4 rad/s²; less what dry friction takes."""
    (tmp_path / "wheel.urdf").write_text(WHEEL.format(limit=limit))
    (tmp_path / "c.yaml").write_text(
        "controller_manager: {ros__parameters: {update_rate: 100, c: {type: effort_controllers/JointGroupEffort"
        "Controller}}}\nc: {ros__parameters: {joints: [axle]}}\n"
    )
    twin = TwinBuilder().robot("wheel", tmp_path / "wheel.urdf", controllers=tmp_path / "c.yaml").build()
    twin.publish("/wheel/c/commands", [2.0])
    velocities = []
    for time in (0.25, 0.5, 1.02):
        twin.advance_to(time)
        velocities += twin.robot_state("wheel").velocities
    assert velocities[1] - velocities[0] == pytest.approx(change, rel=0.01)
    assert velocities[2] == pytest.approx(fastest, rel=0.03)
