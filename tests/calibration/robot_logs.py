"""Logs of the twin's own robots, with noise, and of two links that MuJoCo moves."""

from dataclasses import replace

import numpy as np
from pendulum_logs import ARRAY, STATES, write_log

from drake_twin import Twin
from drake_twin.builder.demo import demo_scenario
from drake_twin.messages.interface_types import make
from drake_twin.scenario import Robot, Scenario, World

ODOMETRY, POSE = "nav_msgs/msg/Odometry", "geometry_msgs/msg/PoseStamped"
COMMANDS, JOINT_STATES = "/robot_1/forward_velocity_controller/commands", "/robot_1/joint_states"

ARM_NOISE = {"position": 1e-3, "velocity": 5e-3, "effort": 2e-2}
ARM = {
    "robot_1.claw.payload": 0.15,
    "robot_1.joint_1.damping": 0.4,
    "robot_1.joint_2.damping": 0.25,
    "robot_1.joint_3.damping": 0.15,
}
ROVER_NOISE = {"position": 1e-3, "velocity": 2e-2, "effort": 5e-2, "place": 1e-3, "angle": 2e-3}
ROVER = {"friction": 0.23, "robot_1.base_link.mass": 17.0, "robot_1.front_left_wheel_joint.damping": 0.35}


def driven(scenario, commands, duration, topics=(JOINT_STATES,), rate=50):
    """Runs a scenario; returns the messages of topics with their times (s), and those of the commands."""
    received = {topic: [] for topic in topics}
    with Twin(scenario) as twin:
        for topic, own in received.items():
            twin.subscribe(topic, lambda message, own=own: own.append((twin.time, message)), rate=rate)
        for time, data in commands:
            twin.advance_to(time)
            twin.publish(COMMANDS, data)
        twin.advance_to(duration)
    return received, [(COMMANDS, ARRAY, time, make(ARRAY, {"data": data})) for time, data in commands]


def noisy_states(states, noise, seed, joints=None, without=()):
    """Joint states with noise, of some joints, as items of a log."""
    generator = np.random.default_rng(seed)
    for time, message in states:
        names = joints or list(message.name)
        places = [list(message.name).index(name) for name in names]
        numbers = {
            kind: np.array(getattr(message, kind))[places] + generator.normal(0, noise[kind], len(names))
            for kind in ("position", "velocity", "effort")
            if kind not in without
        }
        yield JOINT_STATES, STATES, time, make(STATES, {"name": names, **numbers})


def arm():
    """The scenario of the arm, at rest."""
    return demo_scenario("arduinobot", 1, drive=False)


def arm_items(seed=0, duration=2.0, joints=("joint_1", "joint_2", "joint_3")):
    """The log of the arm with a payload of 0.15 kg and other dampings, which waves for 2 s."""
    times = np.arange(0.2, duration, 0.1)
    waves = [
        (float(t), [1.2 * np.sin(5 * (t - 0.2)), 0.8 * np.cos(4 * (t - 0.2)), -np.sin(6 * (t - 0.2) + 1), 0.0])
        for t in times
    ]
    received, items = driven(replace(arm(), values=ARM), waves, duration)
    return [*items, *noisy_states(received[JOINT_STATES], ARM_NOISE, seed, list(joints))]


def rover():
    """The scenario of the rover, at rest."""
    return demo_scenario("rover", 1, drive=False)


def rover_items(seed=0):
    """The log of a heavy rover on slippery ground, seen by a camera above: its wheels slip, it skids and brakes."""
    commands = [(0.1, [15.0] * 4), (0.6, [4.0, 15.0, 4.0, 15.0]), (1.1, [-10.0, -5.0, -10.0, -5.0])]
    truth = "/robot_1/ground_truth/odom"
    received, items = driven(replace(rover(), values=ROVER), commands, 1.5, (JOINT_STATES, truth))
    items += noisy_states(received[JOINT_STATES], ROVER_NOISE, seed)
    generator = np.random.default_rng(seed + 100)
    for time, message in received[truth]:
        place, q = message.pose.pose.position, message.pose.pose.orientation
        yaw = 2 * np.arctan2(q.z, q.w) + generator.normal(0, ROVER_NOISE["angle"])
        x, y = np.array([place.x, place.y]) + generator.normal(0, ROVER_NOISE["place"], 2)
        turned = {"z": np.sin(yaw / 2), "w": np.cos(yaw / 2)}
        items.append(
            ("/camera/pose", POSE, time, make(POSE, {"pose": {"position": {"x": x, "y": y}, "orientation": turned}}))
        )
    return items


# Two links ------------------------------------------------------------------------------------------------------------

LINKS_TOPIC, LINKS_STATES = "/links/effort/commands", "/links/joint_states"
LINKS = {"links.upper.mass": 1.6, "links.lower.mass": 0.9, "links.shoulder.damping": 0.3, "links.elbow.damping": 0.12}

_LINK = """<link name="{name}"><inertial><origin xyz="0 0 -0.2"/><mass value="{mass}"/>
<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
_JOINT = """<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>
<origin xyz="0 0 {z}"/><axis xyz="0 1 0"/><limit velocity="50" effort="50"/><dynamics damping="{damping}"/></joint>"""
_INTERFACES = "".join(
    f'<joint name="{name}"><command_interface name="effort"/><state_interface name="position"/>'
    '<state_interface name="velocity"/></joint>'
    for name in ("shoulder", "elbow")
)
_CONTROLLERS = """\
/**:
  controller_manager:
    ros__parameters:
      update_rate: 100
      states: {type: joint_state_broadcaster/JointStateBroadcaster}
      effort: {type: effort_controllers/JointGroupEffortController}
  effort:
    ros__parameters:
      joints: [shoulder, elbow]
"""


def links_urdf(masses=(1.0, 1.0), dampings=(0.05, 0.05), more=""):
    """Two links that hang from the world."""
    return (
        '<robot name="links"><link name="world"/>'
        + _LINK.format(name="upper", mass=masses[0])
        + _LINK.format(name="lower", mass=masses[1])
        + _JOINT.format(name="shoulder", parent="world", child="upper", z=0, damping=dampings[0])
        + _JOINT.format(name="elbow", parent="upper", child="lower", z=-0.4, damping=dampings[1])
        + f"{more}</robot>"
    )


def links(folder):
    """The scenario of the links with the masses and dampings of their file."""
    (folder / "controllers.yaml").write_text(_CONTROLLERS)
    more = (
        '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>'
        f'{_INTERFACES}</ros2_control><gazebo><plugin filename="x" name="gz_ros2_control::GazeboSimROS2ControlPlugin">'
        f"<parameters>{folder / 'controllers.yaml'}</parameters></plugin></gazebo>"
    )
    (folder / "links.urdf").write_text(links_urdf(more=more))
    robot = Robot("links", str(folder / "links.urdf"))
    return Scenario((robot,), engine="cenic", time_step=0.01, accuracy=1e-5, world=World(ground=False))


def mujoco_log(folder, duration=3.0):
    """The log of the links with other masses and dampings, moved by MuJoCo, with noise."""
    import mujoco

    truth = [*LINKS.values()]
    model = mujoco.MjModel.from_xml_string(links_urdf(truth[:2], truth[2:]))
    model.opt.timestep = 5e-4
    data = mujoco.MjData(model)
    generator = np.random.default_rng(0)
    items = []
    for index in range(round(duration / 0.02)):
        time = index * 0.02
        if index % 5 == 0 and time > 0.1:
            data.qfrc_applied[:] = 3.0 * np.sin(4 * time), 1.0 * np.sin(7 * time)
            items.append((LINKS_TOPIC, ARRAY, time, make(ARRAY, {"data": data.qfrc_applied.tolist()})))
        numbers = {
            "name": ["shoulder", "elbow"],
            "position": data.qpos + generator.normal(0, 1e-3, 2),
            "velocity": data.qvel + generator.normal(0, 5e-3, 2),
        }
        items.append((LINKS_STATES, STATES, time, make(STATES, numbers)))
        mujoco.mj_step(model, data, 40)
    return write_log(folder, items)
