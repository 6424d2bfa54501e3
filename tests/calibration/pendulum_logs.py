"""Logs of a pendulum that no twin has moved: its equation of motion, solved by SciPy, with noise."""

from pathlib import Path

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from scipy.integrate import solve_ivp

from drake_twin.messages import type_store
from drake_twin.messages.interface_types import make, serialize
from drake_twin.scenario import Robot, Scenario, World

ARRAY, STATES, IMU = "std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu"
TOPIC, STATE_TOPIC = "/pendulum/effort/commands", "/pendulum/joint_states"
MASS, DAMPING, LENGTH, INERTIA, GRAVITY = 1.7, 0.23, 0.3, 0.02, 9.81
NOISE = {"position": 2e-3, "velocity": 1e-2}

CONTROLLERS = """\
/**:
  controller_manager:
    ros__parameters:
      update_rate: 100
      states: {type: joint_state_broadcaster/JointStateBroadcaster}
      effort: {type: effort_controllers/JointGroupEffortController}
  effort:
    ros__parameters:
      joints: [hinge]
"""

URDF = f"""<robot name="pendulum"><link name="world"/><link name="arm"><inertial><origin xyz="0 0 -{LENGTH}"/>
<mass value="1"/><inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="continuous"><parent link="world"/><child link="arm"/><axis xyz="0 1 0"/>
<limit velocity="50" effort="50"/></joint>
<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="hinge"><command_interface name="effort"/><state_interface name="position"/>
<state_interface name="velocity"/></joint></ros2_control>
<gazebo><plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
<parameters>CONTROLLERS</parameters></plugin></gazebo></robot>"""


def pendulum(folder: Path, **options) -> Scenario:
    """The scenario of the pendulum, with a mass of 1 kg and no damping."""
    (folder / "controllers.yaml").write_text(CONTROLLERS)
    (folder / "pendulum.urdf").write_text(URDF.replace("CONTROLLERS", str(folder / "controllers.yaml")))
    robot = Robot("pendulum", str(folder / "pendulum.urdf"))
    return Scenario((robot,), engine="cenic", time_step=0.01, accuracy=1e-5, world=World(ground=False), **options)


def motion(duration=1.0, *, friction=0.0):
    """Times (s), positions (rad) and velocities (rad/s) of the pendulum, and the commands: times and torques (N·m).

    Args:
        duration: how long (s).
        friction: a dry friction (N·m) that the twin lacks.
    """
    at = np.arange(0.1, duration, 0.1)
    torques = 2.0 * np.sin(5.0 * at)

    def slope(time, state):
        torque = torques[np.searchsorted(at, time, side="right") - 1] if time >= at[0] else 0.0
        angle, velocity = state
        pull = MASS * GRAVITY * LENGTH * np.sin(angle)
        resisting = DAMPING * velocity + friction * np.tanh(velocity / 1e-2)
        return [velocity, (torque - pull - resisting) / (INERTIA + MASS * LENGTH**2)]

    times = np.arange(0, duration, 0.02)
    found = solve_ivp(slope, (0, duration), [0.0, 0.0], t_eval=times, rtol=1e-9, atol=1e-10, max_step=5e-3)
    return times, found.y[0], found.y[1], at, torques


def messages(seed=0, *, late=0.0, joint="hinge", **options):
    """Yield (topic, type, seconds, message) of a log.

    Args:
        seed: of the noise.
        late: by how much the clock of the measurements is ahead of that of the commands (s).
        joint: the joint's name in the log.
        options: of `motion`.
    """
    generator = np.random.default_rng(seed)
    times, positions, velocities, at, torques = motion(**options)
    for time, torque in zip(at, torques, strict=True):
        yield TOPIC, ARRAY, time, make(ARRAY, {"data": [float(torque)]})
    for time, position, velocity in zip(times, positions, velocities, strict=True):
        numbers = {
            "name": [joint],
            "position": np.array([position + generator.normal(0, NOISE["position"])]),
            "velocity": np.array([velocity + generator.normal(0, NOISE["velocity"])]),
            "effort": np.array([np.nan]),
        }
        yield STATE_TOPIC, STATES, time, stamped(make(STATES, numbers), time + late)


def stamped(message, time):
    """The message with a header of the wall clock at a time of the log (s)."""
    nanoseconds = START + round(time * 1e9)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(nanoseconds, 10**9)
    return message


START = 1_700_000_000_000_000_000  # ns


def write_log(folder, items, plugin=StoragePlugin.MCAP):
    """Writes a bag; a type that drake_twin does not know is written as a text."""
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        connections = {}
        for topic, kind, seconds, message in items:
            if topic not in connections:
                known = {"typestore": type_store()} if not kind.startswith("their_") else THEIRS
                connections[topic] = writer.add_connection(topic, kind, **known)
            content = message if isinstance(message, bytes) else serialize(message)
            writer.write(connections[topic], START + round(seconds * 1e9), content)
    return folder


THEIRS = {
    "msgdef": "float64 torque\n",
    "rihs01": "RIHS01_8fa40072d9072feca84cec36a57ae6dca21cae9e45cd6fe14bb7eb67011f5388",
}
