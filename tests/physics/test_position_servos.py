"""How far a joint is behind a streamed position: 1 / (gain · update rate), as gz_ros2_control's servo."""

import pytest

from drake_twin import TwinBuilder

ROBOT = """<robot name="r"><link name="world"/><link name="arm"><inertial><origin xyz="{center}"/><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="revolute"><parent link="world"/><child link="arm"/><axis xyz="{axis}"/>
    <limit lower="-6" upper="6" effort="100" velocity="10"/></joint>
  <ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin>
    <param name="position_proportional_gain">{gain}</param></hardware>
    <joint name="j"><command_interface name="position"/></joint></ros2_control></robot>"""
YAML = """controller_manager: {{ros__parameters: {{update_rate: {rate},
  positions: {{type: position_controllers/JointGroupPositionController}}}}}}
positions: {{ros__parameters: {{joints: [j]}}}}
"""
ENGINES = {"1ms": {"time_step": 1e-3}, "10ms": {"time_step": 1e-2}, "cenic": {"engine": "cenic"}}
SPEED = 0.5  # rad/s
# A pendulum, and a rotor at which nothing pulls.
PENDULUM, ROTOR = ("0 1 0", "0.3 0 0"), ("0 0 1", "0 0 0")


def lag(folder, engine, rate, gain, body):
    """How long after its command the joint is where it was told (s), at the end of a ramp, in the mean of a tenth."""
    axis, center = body
    (folder / "r.urdf").write_text(ROBOT.format(axis=axis, center=center, gain=gain))
    (folder / "r.yaml").write_text(YAML.format(rate=rate))
    builder = TwinBuilder(**ENGINES[engine])
    twin = builder.robot("r", folder / "r.urdf", controllers=[folder / "r.yaml"]).build()
    count, lags = int(max(0.2, 8 / (gain * rate)) * rate), []
    for update in range(count):
        twin.publish("/r/positions/commands", [SPEED * update / rate])
        twin.advance_to((update + 1) / rate)
        lags.append(update / rate - twin.robot_state("r").positions[0] / SPEED)
    last = lags[-max(3, count // 10) :]
    return sum(last) / len(last)


CASES = [(50, 0.1), (100, 1.0), (500, 0.1), (500, 1.0), (1000, 0.5), (1000, 1.0)]


@pytest.mark.parametrize(
    ("engine", "rate", "gain"),
    [(engine, *case) for engine in ("1ms", "cenic") for case in CASES] + [("10ms", *case) for case in CASES[:2]],
)
def test_a_joint_with_a_weight_lags_as_gazebos_servo_within_a_period(tmp_path, engine, rate, gain):
    assert lag(tmp_path, engine, rate, gain, PENDULUM) == pytest.approx(1 / (gain * rate), abs=1 / rate)


@pytest.mark.parametrize(("rate", "gain"), [(50, 0.1), (100, 1.0), (1000, 0.1)])
@pytest.mark.parametrize("engine", ["1ms", "cenic"])
def test_one_at_which_nothing_pulls_lags_so_down_to_ten_milliseconds(tmp_path, engine, rate, gain):
    assert lag(tmp_path, engine, rate, gain, ROTOR) == pytest.approx(1 / (gain * rate), abs=1 / rate)


def test_such_a_joint_is_some_nine_milliseconds_behind_at_a_higher_rate(tmp_path):  # docs/control.md
    assert 5e-3 < lag(tmp_path, "1ms", 1000, 1.0, ROTOR) < 10e-3
