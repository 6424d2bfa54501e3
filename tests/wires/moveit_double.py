"""What MoveIt's move_group does with an arm, its planner apart: a trajectory between two poses, timed, is executed.

Its parts that touch the robot, with their topics, actions and quality of service: the robot's description from its
topic, CurrentStateMonitor, MoveItSimpleControllerManager with the trajectory execution manager's checks, and
Ros2ControlManager, which finds the controllers by itself. Run with the wire and its domain; prints what it found.
"""

import sys
from pathlib import Path

import yaml
from lxml import etree
from program_runs import MODELS
from wires.outside_node import OutsideAction, OutsideNode, run, seconds, stamp_of

CONFIG = MODELS / "arduinobot_moveit_config" / "config"
_RATE = 10.0  # points of a trajectory a second, as of TOTG's resample_dt 0.1 s
_TYPES = {
    "FollowJointTrajectory": "control_msgs/action/FollowJointTrajectory",
    "GripperCommand": "control_msgs/action/GripperCommand",
}


def config(file):
    return yaml.safe_load((CONFIG / file).read_text("utf-8"))


class MoveGroup:
    def __init__(self, node: OutsideNode):
        self.node, self.states, self.descriptions, self.stamps = node, {}, [], []
        self.srdf = etree.parse(CONFIG / "arduinobot.srdf").getroot()
        self.limits = config("joint_limits.yaml")
        execution = config("moveit_controllers.yaml")
        self.execution = execution["trajectory_execution"]
        node.listen("/robot_description", "std_msgs/msg/String", self._hear_description, latched=True, depth=1)
        node.listen("/joint_states", "sensor_msgs/msg/JointState", self._hear_states, depth=25)
        manager = execution["moveit_simple_controller_manager"]
        self.actions = {
            name: OutsideAction(node, f"/{name}/{manager[name]['action_ns']}", _TYPES[manager[name]["type"]])
            for name in manager["controller_names"]
        }
        self.joints = {name: manager[name]["joints"] for name in manager["controller_names"]}

    def _hear_description(self, message):
        self.descriptions.append(message.data)

    def _hear_states(self, message):
        self.stamps.append(seconds(message.header.stamp))
        self.states.update(zip(message.name, message.position, strict=True))

    def group(self, name, state):
        """The joints' positions of a pose of the SRDF."""
        (found,) = self.srdf.xpath(f"group_state[@group='{name}'][@name='{state}']")
        return {joint.get("name"): float(joint.get("value")) for joint in found.iter("joint")}

    def wait_for_states(self):
        """Wait until all joints of the model are known, of a time that is not before now."""
        model = etree.fromstring(self.descriptions[0].encode())
        moving = {joint.get("name") for joint in model.iter("joint") if joint.get("type") in ("revolute", "prismatic")}
        now = self.node.time
        self.node.spin(lambda: moving <= set(self.states) and self.stamps and self.stamps[-1] >= now)
        return sorted(moving)

    def trajectory(self, goal):
        """Quintic in time, slow enough for the limits: from where the arm is to a goal."""
        self.wait_for_states()
        names = list(goal)
        start = [self.states[name] for name in names]
        far = [goal[name] - at for name, at in zip(names, start, strict=True)]
        scale = self.limits["default_velocity_scaling_factor"]
        speed = min(self.limits["joint_limits"][name]["max_velocity"] for name in names) * scale
        duration = max(15 / 8 * max(map(abs, far)) / speed, 0.5)
        points, count = [], int(duration * _RATE) + 1
        for index in range(count + 1):
            s = index / count
            along, rate = s**3 * (10 - 15 * s + 6 * s * s), 30 * s**2 * (1 - s) ** 2 / duration
            points.append(
                {
                    "positions": [at + along * step for at, step in zip(start, far, strict=True)],
                    "velocities": [rate * step for step in far],
                    "accelerations": [60 * s * (1 - 3 * s + 2 * s * s) / duration**2 * step for step in far],
                    "time_from_start": stamp_of(s * duration),
                }
            )
        return {"joint_names": names, "points": points}, duration

    def execute(self, controller, goal):
        """Send a trajectory and wait for its end; return how it ended, how long it took, and how far it is off."""
        trajectory, duration = self.trajectory(goal)
        start = dict(zip(goal, trajectory["points"][0]["positions"], strict=True))
        began = self.node.time
        sent = self.send(controller, trajectory)
        status, result = sent.result()
        took = self.node.time - began
        self.node.spin(lambda: self.stamps[-1] > began + took + 0.1)  # as it waits for the robot to stop
        tolerance = self.execution["allowed_start_tolerance"]
        return {
            "accepted": sent.accepted,
            "status": status,
            "error_code": int(getattr(result, "error_code", 0)),
            "duration": duration,
            "in_time": took
            < duration * self.execution["allowed_execution_duration_scaling"]
            + self.execution["allowed_goal_duration_margin"],
            "early": took < duration - 0.1,
            "moved": max(abs(goal[name] - start[name]) for name in goal),
            "off": max(abs(self.states[name] - goal[name]) for name in goal),
            "next_can_start": all(abs(self.states[name] - goal[name]) < tolerance for name in goal),
            "feedback": len(sent.feedback),
        }

    def send(self, controller, trajectory):
        if controller == "gripper_controller":
            command = {"position": trajectory["points"][-1]["positions"][0], "max_effort": 0.0}
            return self.actions[controller].send({"command": command})
        return self.actions[controller].send({"trajectory": trajectory})


def canceled(group, controller, goal):
    """What ends a motion when it is stopped halfway, and whether the arm stands then."""
    trajectory, duration = group.trajectory(goal)
    sent, began = group.send(controller, trajectory), group.node.time
    group.node.spin(lambda: group.node.time > began + duration / 2)
    count = sent.cancel()
    status, _ = sent.result()
    return {"canceling": count, "status": status, **stands(group, goal)}


def stands(group, joints):
    """How far the arm moves in half a second, one second after."""
    later = group.node.time + 1.0
    group.node.spin(lambda: group.stamps[-1] > later)
    before = dict(group.states)
    group.node.spin(lambda: group.stamps[-1] > later + 0.5)
    return {"drift": max(abs(group.states[name] - before[name]) for name in joints)}


def preempted(group, controller, first, second):
    """How both of two goals end of which the second comes during the first."""
    trajectory, duration = group.trajectory(first)
    sent, began = group.send(controller, trajectory), group.node.time
    group.node.spin(lambda: group.node.time > began + duration / 2)
    after = group.execute(controller, second)
    status, result = sent.result()
    return {"first": [status, int(result.error_code), result.error_string], "second": after}


def refused(group, controller, names, positions):
    """Whether a goal with these joints is accepted."""
    point = {"positions": positions, "time_from_start": {"sec": 1}}
    return group.send(controller, {"joint_names": names, "points": [point]}).accepted


def controllers(node):
    """The controllers as Ros2ControlManager sees them: type, state, joints that are claimed and required."""
    client = node.service("/controller_manager/list_controllers", "controller_manager_msgs/srv/ListControllers")
    found = {}
    for each in client.call({}).controller:
        joints = [name.split("/")[0] for name in each.claimed_interfaces]
        required = [name.split("/")[0] for name in each.required_command_interfaces]
        found[each.name] = [each.type, each.state, joints, required]
    return found


def switch(node, activate, deactivate):
    client = node.service("/controller_manager/switch_controller", "controller_manager_msgs/srv/SwitchController")
    best_effort = 1
    request = {"activate_controllers": activate, "deactivate_controllers": deactivate, "strictness": best_effort}
    return bool(client.call(request).ok)


def move_group(node):
    group, arm, gripper = MoveGroup(node), "joint_trajectory_controller", "gripper_controller"
    node.spin(lambda: node.time > 0 and group.descriptions)
    home, reach = group.group("arm", "home"), group.group("arm", "reach")
    found = {
        "joints": group.wait_for_states(),
        "controllers": controllers(node),
        "reach": group.execute(arm, reach),
        "close": group.execute(gripper, group.group("gripper", "closed")),
        "open": group.execute(gripper, group.group("gripper", "open")),
        "canceled": canceled(group, arm, home),
        "preempted": preempted(group, arm, home, reach),
        "partial": refused(group, arm, ["joint_1"], [0.0]),
        "unknown": refused(group, arm, ["joint_1", "joint_2", "joint_9"], [0.0] * 3),
    }
    found["switched"] = switch(node, [], [arm])
    found["inactive"] = controllers(node)[arm]
    found["refused_when_inactive"] = refused(group, arm, list(home), [0.0] * 3)
    found["switched_back"] = switch(node, [arm], [])
    found["home"] = group.execute(arm, home)
    found["descriptions"] = len(group.descriptions)
    return found


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parents[1]))
    run(move_group)
