"""Grammars of scenarios, controllers' parameters and launch files in XML, YAML and Python."""

from xml.etree import ElementTree

import yaml
from choices import WORDS, Choices, as_xml, damaged
from xml_grammars import add

CONTROLLERS = {
    "forward": "velocity_controllers/JointGroupVelocityController",
    "positions": "position_controllers/JointGroupPositionController",
    "drive": "diff_drive_controller/DiffDriveController",
    "trajectory": "joint_trajectory_controller/JointTrajectoryController",
    "broadcaster": "joint_state_broadcaster/JointStateBroadcaster",
    "forward_command": "forward_command_controller/ForwardCommandController",
    "pid": "pid_controller/PidController",
    "gripper": "position_controllers/GripperActionController",
}


def as_yaml(data, c: Choices) -> bytes:
    """Write plain data, now and then with a tag, an anchor, an alias of itself or of many, or very deep."""
    text = yaml.safe_dump(c.altered(data), sort_keys=False, default_flow_style=c.choice((None, True, False)))
    if c.is_wrong():
        at = c.randrange(len(text) + 1)
        aliases = "".join(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]\n" for n in range(1, 9))
        bad = ("!!python/object/apply:os.system [ls]\n", "&x [*x]\n", "*y\n", "? [a]\n: b\n", "<<: *x\n", "--- \n")
        bad += ("[" * 2_000, "{a: " * 500, "- " * 3_000, "a0: &a0 1\n" + aliases, "!!binary x\n", "!!set {a}\n")
        text = text[:at] + c.choice(bad) + text[at:] if c.maybe() else c.choice(bad) + text
    return damaged(text.encode("utf-8", "surrogatepass"), c)


def typed(c: Choices, usual, low: float = 0.0, high: float = 1.0):
    """A plain value that is mostly of the type it must have."""
    if c.is_wrong():
        return c.value()
    return c.uniform(low, high) if usual is float else usual


def scenario(choices: Choices) -> dict[str, bytes]:
    c = choices
    robots = []
    for number in range(c.choice((1, 1, 2))):
        robot = {"name": typed(c, f"r{number}"), "model": typed(c, c.choice(("robot.urdf", "robot.sdf")))}
        if c.maybe():
            robot["xyz"] = [typed(c, float, -2, 2) for _ in range(3)]
        if c.maybe(0.3):
            robot["rpy"] = [typed(c, float, -3, 3) for _ in range(3)]
        if c.maybe(0.3):
            robot["controllers"] = typed(c, ["controllers.yaml"])
        if c.is_wrong():
            robot["xacro_args"] = typed(c, {"size": "1"})
        robots.append(robot)
    data = {"robots": robots}
    extra = {
        "time_step": typed(c, 0.001),
        "seed": typed(c, 3),
        "world": typed(c, {"ground": True, "ground_friction": typed(c, 0.5), "gravity": typed(c, -9.8)}),
        "static_transforms": [{"parent": typed(c, "world"), "child": typed(c, "odom"), "xyz": [typed(c, float)] * 3}],
        "commands": [{"topic": typed(c, "/r0/forward/commands"), "data": [typed(c, 1.0)], "time": typed(c, float)}],
        "clock_rate": typed(c, 100.0),
        "sensor_noise": typed(c, False),
        "package_paths": typed(c, ["."]),
    }
    data |= {name: extra[name] for name in c.some(*extra, most=4)}
    forward = {"type": CONTROLLERS["forward"]}
    control = {"controller_manager": {"ros__parameters": {"forward": forward}}}
    control["forward"] = {"ros__parameters": {"joints": ["left_joint"]}}
    return {"scenario.yaml": as_yaml(data, c), "controllers.yaml": yaml.safe_dump(control).encode()}


def controllers(choices: Choices) -> dict[str, bytes]:
    c = choices
    chosen = c.some(*CONTROLLERS, most=3) or ["forward"]
    manager = {"update_rate": typed(c, 100)} | {name: {"type": typed(c, CONTROLLERS[name])} for name in chosen}
    data = {"controller_manager": {"ros__parameters": manager}}
    for name in chosen:
        joints = typed(c, c.some("left_joint", "right_joint", most=2) or ["left_joint"])
        parameters = {
            "joints": joints,
            "interface_name": typed(c, "velocity"),
            "left_wheel_names": typed(c, ["left_joint"]),
            "right_wheel_names": typed(c, ["right_joint"]),
            "wheel_separation": typed(c, float),
            "wheel_radius": typed(c, float),
            "command_interfaces": typed(c, ["velocity"]),
            "state_interfaces": typed(c, ["position", "velocity"]),
            "publish_rate": typed(c, float, 1, 50),
            "gains": typed(c, {"left_joint": {"p": typed(c, 1.0), "i": typed(c, 0.0), "u_clamp_max": typed(c, 1.0)}}),
            "dof_names": typed(c, ["left_joint"]),
            "linear.x.max_velocity": typed(c, float),
            "constraints": typed(c, {"goal_time": typed(c, float)}),
        }
        kept = {key: value for key, value in parameters.items() if not c.is_wrong()}
        data[c.choice((name, name, name, f"/**/{name}", "/**"))] = {"ros__parameters": kept}
    return {"controllers.yaml": as_yaml(data, c)}


SPAWNED = "-file FOLDER/robot.sdf"
TEXTS = ("$(var n)", "a", "$(env HOME)", "$(find-pkg-share rover_description)", "$(eval '1 + 1')", "$(anon x)")
WRONG_TEXTS = ("$(var none)", "$(eval '9**9**9')", "$(eval '().__class__')", "$(command 'cat /etc/passwd')", "$(")
WRONG_TEXTS += ("$(var $(var $(var n)))", "$(file-content /dev/zero)", "$(nothing x)", "$()", "$(find-pkg-share none)")


def text(c: Choices, *usual: str) -> str:
    if c.is_wrong():
        return c.choice((*WRONG_TEXTS, *WORDS))
    return c.choice(usual or TEXTS)


def _actions(c: Choices, depth: int = 0) -> list[tuple[str, dict[str, str], list]]:
    """Launch actions: tag, attributes and inner actions."""
    found: list[tuple[str, dict[str, str], list]] = []
    for _ in range(c.choice((1, 2, 3))):
        conditions = {"if": text(c, "true", "false")} if c.maybe(0.15) else {}
        match c.randrange(10):
            case 0:
                found.append(("arg", {"name": text(c, "n", "m"), "default": text(c)}, []))
            case 1:
                found.append(("let", {"name": text(c, "n", "m"), "value": text(c), **conditions}, []))
            case 2 if depth < 4:
                found.append(("group", conditions, _actions(c, depth + 1)))
            case 3:
                found.append(("push_ros_namespace", {"namespace": text(c, "a", "$(var n)", "/")}, []))
            case 4:
                found.append(("include", {"file": text(c, "FOLDER/part.launch.xml"), **conditions}, []))
            case 5 if depth < 4:
                found.append(("timer", {"period": text(c, "0.0", "1.0")}, _actions(c, depth + 1)))
            case 6:
                tag = c.tag("set_env", "set_parameter", "unset_env")
                found.append((tag, {"name": text(c, "X")} | ({} if tag == "unset_env" else {"value": text(c)}), []))
            case 7:
                found.append(("executable", {"cmd": text(c, "echo hello", "ros2 topic list")}, []))
            case _:
                found.append(_node(c, conditions))
    return found


def _node(c: Choices, conditions: dict[str, str]) -> tuple[str, dict[str, str], list]:
    remap = ("remap", {"from": text(c, "a", "/tf"), "to": text(c, "b")}, [])
    parameter = ("param", {"name": text(c, "use_sim_time", "rate"), "value": text(c, "true", "30")}, [])
    inner = [item for item in (remap, parameter) if c.maybe(0.3)]
    package, executable = c.choice(
        (("tf2_ros", "static_transform_publisher"), ("ros_gz_sim", "create"), ("rviz2", "rviz2"), ("none", "none"))
    )
    arguments = {"tf2_ros": "--frame-id world --child-frame-id o --x 1", "ros_gz_sim": f"-name $(var n) {SPAWNED}"}
    node = {"pkg": text(c, package), "exec": text(c, executable), "args": text(c, arguments.get(package, "-x"))}
    return ("node", node | conditions, inner)


def _spawned(c: Choices) -> list[tuple[str, dict[str, str], list]]:
    """A robot, so that the launch file starts one."""
    name = {"name": "n", "default": text(c, "a")}
    args = text(c, "-name $(var n) -file FOLDER/robot.sdf -z 1", "-name a -file FOLDER/robot.urdf -x 1 -Y 0.5")
    return [("arg", name, []), ("node", {"pkg": "ros_gz_sim", "exec": "create", "args": args}, [])]


def _launch_element(parent: ElementTree.Element, actions) -> None:
    for tag, attributes, inner in actions:
        _launch_element(add(parent, tag, **attributes), inner)


def launch_xml(choices: Choices) -> dict[str, bytes]:
    root = ElementTree.Element("launch")
    _launch_element(root, _spawned(choices) + _actions(choices))
    part = ElementTree.Element("launch")
    _launch_element(part, _actions(choices, 3))
    return {"main.launch.xml": as_xml(root, choices), "part.launch.xml": as_xml(part, choices)}


def _launch_data(actions) -> list:
    found = []
    for tag, attributes, inner in actions:
        found.append({tag: attributes | ({"children": _launch_data(inner)} if inner else {})})
    return found


def launch_yaml(choices: Choices) -> dict[str, bytes]:
    data = {"launch": _launch_data(_spawned(choices) + _actions(choices))}
    part = b"<launch><arg name='m' default='1'/></launch>"
    return {"main.launch.yaml": as_yaml(data, choices), "part.launch.xml": part}


PYTHON = """from launch import LaunchDescription
from launch.actions import {imported}
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution, TextSubstitution
from launch_ros.actions import Node


def generate_launch_description():
    {body}
    return {returned}
"""


def launch_py(choices: Choices) -> dict[str, bytes]:
    """Python launch files: their values are literals, none of them runs a stranger's program."""
    c = choices

    def literal(*usual: str) -> str:
        return repr(c.value() if c.is_wrong() else text(c, *usual))

    spawned = f"'-name', {literal('a')}, '-file', 'FOLDER/robot.sdf', '-z', {literal('1', '0.5')}"
    entities = [f"Node(package='ros_gz_sim', executable='create', arguments=[{spawned}])"]
    for _ in range(c.choice((0, 1, 3))):
        kinds = (
            f"DeclareLaunchArgument({literal('n')}, default_value={literal('a')}, description={literal('b')})",
            f"SetEnvironmentVariable({literal('X')}, {literal('1')})",
            f"GroupAction([Node(package={literal('rviz2')}, executable={literal('rviz2')})])",
            f"TimerAction(period={literal('1.0')}, actions=[LogInfo(msg={literal('hello')})])",
            f"LogInfo(msg=LaunchConfiguration({literal('none')}, default={literal('a')}))",
            f"OpaqueFunction(function=lambda context: {c.value() if c.is_wrong() else []!r})",
            f"Node(package={literal('a')}, executable={literal('b')}, parameters=[{{'a': {literal('1')}}}])",
            f"IncludeLaunchDescription({literal('FOLDER/part.launch.xml')})",
        )
        entities.append(c.choice(kinds))
    imported = "DeclareLaunchArgument, SetEnvironmentVariable, GroupAction, TimerAction, LogInfo, OpaqueFunction"
    body = "pass"
    if c.is_wrong():
        endless = "return generate_launch_description()"
        body = c.choice(("raise ValueError('x\\ny')", "import sys; sys.exit(3)", "1 / 0", endless))
    returned = f"LaunchDescription([{', '.join(entities)}])"
    if c.is_wrong():
        returned = repr(c.value())
    written = PYTHON.format(imported=f"{imported}, IncludeLaunchDescription", body=body, returned=returned)
    written = written.replace("nan", "float('nan')").replace("inf,", "float('inf'),")
    part = b"<launch><arg name='m' default='1'/></launch>"
    return {"main.launch.py": damaged(written.encode("utf-8", "surrogatepass"), c), "part.launch.xml": part}
