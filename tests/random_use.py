"""Random use of a robot with many controllers: calls of its services, topics and actions."""

import numpy as np

from drake_twin import TwinBuilder
from drake_twin.twin.controller_manager import FORCE_AUTO

INERTIA = '<inertia ixx="0.05" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/>'
JOINTS = ("shoulder", "elbow", "left", "right", "finger")
KINDS = dict.fromkeys(JOINTS, "continuous") | {"shoulder": "revolute", "elbow": "revolute", "finger": "prismatic"}
PARENTS = dict.fromkeys(JOINTS, "base") | {"elbow": "link_shoulder", "finger": "link_elbow"}
LIMITS = {"continuous": "", "revolute": 'lower="-2" upper="2"', "prismatic": 'lower="0" upper="0.1"'}
NAMES = ("position", "velocity", "effort")

CONTROLLERS = {
    "broadcaster": ("joint_state_broadcaster/JointStateBroadcaster", "{}"),
    "trajectories": (
        "joint_trajectory_controller/JointTrajectoryController",
        "{joints: [shoulder, elbow], command_interfaces: [position], state_interfaces: [position, velocity]}",
    ),
    "torques": (
        "joint_trajectory_controller/JointTrajectoryController",
        (
            "{joints: [shoulder, elbow], command_interfaces: [effort], state_interfaces: [position, velocity],"
            " gains: {shoulder: {p: 40.0, d: 4.0}, elbow: {p: 20.0, d: 2.0}}}"
        ),
    ),
    "positions": ("position_controllers/JointGroupPositionController", "{joints: [shoulder, elbow]}"),
    "velocities": ("velocity_controllers/JointGroupVelocityController", "{joints: [shoulder, left]}"),
    "efforts": ("effort_controllers/JointGroupEffortController", "{joints: [elbow, right]}"),
    "inner_pid": (
        "pid_controller/PidController",
        (
            "{dof_names: [elbow], command_interface: effort, reference_and_state_interfaces: [velocity],"
            " gains: {elbow: {p: 4.0}}}"
        ),
    ),
    "pid": (
        "pid_controller/PidController",
        (
            "{dof_names: [inner_pid/elbow], reference_and_state_dof_names: [elbow], command_interface: velocity,"
            " reference_and_state_interfaces: [position], gains: {inner_pid/elbow: {p: 5.0}}}"
        ),
    ),
    "above_pid": (
        "forward_command_controller/ForwardCommandController",
        "{joints: [pid/elbow], interface_name: position}",
    ),
    "wheels": (
        "diff_drive_controller/DiffDriveController",
        "{left_wheel_names: [left], right_wheel_names: [right], wheel_separation: 0.4, wheel_radius: 0.1}",
    ),
    "gripper": ("position_controllers/GripperActionController", "{joint: finger, goal_tolerance: 0.001}"),
    "broken": ("velocity_controllers/JointGroupVelocityController", "{joints: [anchor]}"),
}
CHAIN = ("inner_pid", "pid", "above_pid")  # from the joint up: each writes to the one before it
AT_START = ("broadcaster", "trajectories", "wheels", "gripper")


def write_files(folder):
    """The robot's file and its controllers'."""
    links = [f'<link name="{name}"/>' for name in ("world", "base", "weight")]
    joints = ['<joint name="anchor" type="fixed"><parent link="world"/><child link="base"/></joint>']
    joints.append('<joint name="stiff" type="fixed"><parent link="base"/><child link="weight"/></joint>')
    for name, kind in KINDS.items():
        offset = "0.2 0 0" if kind == "revolute" else "0 0 0"
        links.append(
            f'<link name="link_{name}"><inertial><origin xyz="{offset}"/><mass value="1"/>{INERTIA}</inertial></link>'
        )
        joints.append(
            f'<joint name="{name}" type="{kind}"><parent link="{PARENTS[name]}"/><child link="link_{name}"/>'
            f'<axis xyz="0 1 0"/><limit effort="30" velocity="6" {LIMITS[kind]}/></joint>'
        )
    interfaces = "".join(
        f'<joint name="{name}">'
        + "".join(f'<command_interface name="{item}"/><state_interface name="{item}"/>' for item in NAMES)
        + "</joint>"
        for name in JOINTS
    )
    control = (
        '<ros2_control name="system" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin>'
        f"</hardware>{interfaces}</ros2_control>"
    )
    robot, controllers = folder / "robot.urdf", folder / "controllers.yaml"
    robot.write_text(f'<robot name="robot">{"".join((*links, *joints))}{control}</robot>')
    types = "".join(f"    {name}: {{type: {kind}}}\n" for name, (kind, _) in CONTROLLERS.items())
    parameters = "".join(f"{name}:\n  ros__parameters: {text}\n" for name, (_, text) in CONTROLLERS.items())
    controllers.write_text(
        f"controller_manager:\n  ros__parameters:\n    enforce_command_limits: true\n{types}{parameters}"
    )
    return robot, controllers


def build(files, names=("used", "alone")):
    """A twin of robots of these files."""
    robot, controllers = files
    builder = TwinBuilder(time_step=0.002)
    for name in names:
        builder.robot(
            name,
            robot,
            xyz=(0, 0 if name == "used" else 5, 2),
            controllers=controllers,
            active_controllers=AT_START,
            inactive_controllers=("positions", "velocities", "pid"),
        )
    return builder.build()


class RandomUse:
    """Calls of one robot's services, topics and actions, chosen by a generator of random numbers."""

    def __init__(self, twin, generator):
        self.twin = twin
        self.random = generator
        self.manager = twin.control.manager("used")
        self.goals = []

    def call(self):
        """One random call; returns its name."""
        names = ["load", "configure", "switch", "chain", "unload", "publish", "send_goal", "cancel"]
        names.append("set_joint_positions")
        weights = [1, 1, 4, 1, 1, 5, 3, 1, 0.3]
        rare = ["emergency_stop", "clear_emergency_stop", "reset", "pause"]
        chances = np.array([*weights, 0.4, 1.0, 0.3, 0.3])
        name = str(self.random.choice(names + rare, p=chances / chances.sum()))
        getattr(self, name)()
        return name

    def load(self):
        self.manager.load_controller(self._controller())

    def configure(self):
        self.manager.configure_controller(self._controller())

    def unload(self):
        self.manager.unload_controller(self._controller())

    def switch(self):
        count = self.random.integers(0, 3, 2)
        activate, deactivate = ([self._controller() for _ in range(each)] for each in count)
        self.manager.switch_controller(activate, deactivate, int(self.random.integers(0, 6)))

    def chain(self):
        """Load, configure and activate the lower controllers of the chain; deactivate all that are in the way."""
        names = CHAIN[: int(self.random.choice([1, 2, 3], p=[0.2, 0.2, 0.6]))]
        for name in names:
            self.manager.load_controller(name)
            self.manager.configure_controller(name)
        missing = [name for name in names if name not in self.manager.active]
        self.manager.switch_controller(missing, strictness=FORCE_AUTO)

    def publish(self):
        topic = self.topic()
        self.twin.publish(topic, self.message(topic))

    def topic(self):
        """A topic of the robot."""
        return str(self.random.choice([topic for topic in self.twin.built.commanded if topic.startswith("/used/")]))

    def message(self, topic):
        """Something to publish there, most often of the right shape."""
        kind = self.twin.built.commanded[topic].type
        if kind.endswith("Float64MultiArray"):
            return [self._number() for _ in range(self.random.choice([2, 2, 2, 1, 0]))]
        if kind.endswith("TwistStamped"):
            stamp = self.random.choice([0.0, self.twin.time, self.twin.time - 0.1, -3.0, 1e6])
            return {"header": {"stamp": stamp}, "twist": {"linear": {"x": self._number()}, "angular": {"z": 0.5}}}
        if kind.endswith("JointTrajectory"):
            return self._trajectory()
        if kind.endswith("MultiDOFCommand"):
            return {"dof_names": ["elbow"], "values": [self._number()]}
        return {"factor": self._number()}

    def send_goal(self):
        if self.random.random() < 0.6:
            name = self.random.choice(["trajectories", "torques"])
            sent = (f"/used/{name}/follow_joint_trajectory", {"trajectory": self._trajectory()})
        else:
            goal = {"command": {"position": self._number() / 50, "max_effort": self._number()}}
            sent = ("/used/gripper/gripper_cmd", goal)
        self.goals.append(self.twin.graph.send_goal(*sent, self._on_result))

    def cancel(self):
        if self.goals:
            self.goals[int(self.random.integers(len(self.goals)))].cancel()

    def set_joint_positions(self):
        self.twin.entities.set_joint_positions("used", {"left": self._number()})

    def emergency_stop(self):
        self.twin.control.emergency_stop("used")

    def clear_emergency_stop(self):
        self.twin.control.clear_emergency_stop("used")

    def reset(self):
        self.twin.reset()

    def pause(self):
        self.twin.pause() if self.random.random() < 0.5 else self.twin.play()

    def _on_result(self, goal):
        assert goal.is_done
        if self.random.random() < 0.3:
            self.switch()

    def _controller(self):
        return str(self.random.choice([*CONTROLLERS, "nobody"]))

    def _number(self):
        if self.random.random() < 0.05:
            return float(self.random.choice([np.nan, np.inf, -np.inf, 1e300, 1e-300]))
        return float(self.random.normal(0.0, 1.5))

    def _trajectory(self):
        times = np.cumsum(self.random.choice([0.02, 0.1, 0.3, 0.0], 2, p=[0.3, 0.3, 0.35, 0.05]))
        joints = ["shoulder", "elbow"] if self.random.random() < 0.9 else ["elbow"]
        points = [{"positions": [self._number() for _ in joints], "time_from_start": float(time)} for time in times]
        return {"joint_names": joints, "points": points}
