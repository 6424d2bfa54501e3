"""The systems of gz-sim that drive multicopters: all those of a robot as one controller."""

from typing import Any

from drake_twin.description.gazebo_drive import (
    MULTICOPTER,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    Servo,
    gazebo_plugin,
)
from drake_twin.description.gazebo_plugins import plugin_kind
from drake_twin.description.robot_description import GazeboPlugin

_MOTOR = "multicopter-motor-model-system"
_CONTROLS = ("multicopter-control-system", "multicopter-velocity-control-system")  # its library, its class
_RATE = 250.0  # Hz, of the control of a velocity; what a step of 4 ms and more cannot do

_TURNS = {"cw": -1, "ccw": 1}
_ROTOR = "rotorConfiguration/rotor"

# Element → parameter, gz-sim's default.
_NUMBERS = {
    "motorConstant": ("motor_constants", 8.54858e-06),
    "momentConstant": ("moment_constants", 0.016),
    "maxRotVelocity": ("max_rot_velocities", 838.0),
    "timeConstantUp": ("time_constants_up", 1.0 / 80.0),
    "timeConstantDown": ("time_constants_down", 1.0 / 40.0),
    "rotorDragCoefficient": ("rotor_drag_coefficients", 1.0e-4),
    "rollingMomentCoefficient": ("rolling_moment_coefficients", 1.0e-6),
    "rotorVelocitySlowdownSim": ("rotor_velocity_slowdowns", 10.0),
}
_POSITIVE = {"maxRotVelocity", "timeConstantUp", "timeConstantDown", "rotorVelocitySlowdownSim"}
_GAINS = {"velocityGain": "velocity_gain", "attitudeGain": "attitude_gain", "angularRateGain": "angular_rate_gain"}
_LIMITS = {
    "maximumLinearAcceleration": "maximum_linear_acceleration",
    "maximumLinearVelocity": "maximum_linear_velocity",
    "maximumAngularVelocity": "maximum_angular_velocity",
}
_NOISE = (
    "linearVelocityNoiseMean",
    "linearVelocityNoiseStdDev",
    "angularVelocityNoiseMean",
    "angularVelocityNoiseStdDev",
)


@gazebo_plugin("gz-sim-multicopter-motor-model-system")
def multicopter_motor_model_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-multicopter-motor-model-system``: the first one with a topic for all with the same one."""
    rotor, topic = _rotor(plugin), _topic(plugin, "")
    control = next((item for item in plugin.description.plugins if plugin_kind(item) in _CONTROLS), None)
    motors = [item for item in plugin.description.plugins if plugin_kind(item) == _MOTOR]
    fellows = [item for item in motors if control or _topic(_reader(plugin, item), "") == topic]
    if fellows[0] is not plugin.plugin:
        return GazeboDrive(plugin.plugin, is_part=True)
    rotors = [rotor, *(_rotor(_reader(plugin, item)) for item in fellows[1:])]
    parameters: dict[str, Any] = {name: [item[name] for item in rotors] for name in rotor}
    interfaces = tuple((joint, "velocity") for joint in parameters["joints"])
    if control is None:
        names = {"motor_speed": topic}
    else:
        reader = _reader(plugin, control)
        parameters |= _control(reader) | {"controls_velocity": True, "update_rate": _RATE}
        names = {"cmd_vel": _topic(reader, "cmd_vel"), "enable": _topic(reader, "enable", "enableSubTopic")}
    return plugin.drive(
        MULTICOPTER,
        parameters,
        topics={own: below for own, (_, below) in names.items()},
        gz_topics={own: f"/{namespace}/{below}" for own, (namespace, below) in names.items()},
        interfaces=interfaces,
        servos={
            interface: Servo(time_constant=up)
            for interface, up in zip(interfaces, parameters["time_constants_up"], strict=True)
        },
    )


@gazebo_plugin(*(f"gz-sim-{kind}" for kind in _CONTROLS))
def multicopter_control_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-multicopter-control-system``, whose work the controller of the rotors does."""
    if not any(plugin_kind(item) == _MOTOR for item in plugin.description.plugins):
        raise CannotWorkError("the robot has no rotor of gz-sim-multicopter-motor-model-system")
    _control(plugin)
    _topic(plugin, "cmd_vel")
    _topic(plugin, "enable", "enableSubTopic")
    return GazeboDrive(plugin.plugin, is_part=True)


def _reader(like: DrivePlugin, plugin: GazeboPlugin) -> DrivePlugin:
    return DrivePlugin(plugin, like.description, like.name)


def _topic(plugin: DrivePlugin, default: str, tag: str = "commandSubTopic") -> tuple[str, str]:
    """Return the namespace of a topic of gz's transport, and the topic below it."""
    return plugin.text("robotNamespace", "{model}").strip("/"), plugin.text(tag, default).strip("/")


def _rotor(plugin: DrivePlugin) -> dict[str, Any]:
    """Return the parameters of one rotor."""
    (joint,) = plugin.joints("jointName")[:1]
    link = plugin.link("linkName")
    if (kind := plugin.text("motorType", "velocity")) != "velocity":
        raise CannotWorkError(f"<motorType> is {kind!r}, and gz-sim drives 'velocity' alone")
    turns = plugin.text("turningDirection", "")
    if turns not in _TURNS:
        raise plugin.error(f"<turningDirection> is {turns!r}, which is neither 'cw' nor 'ccw'")
    number = plugin.number("actuator_number", plugin.number("motorNumber", 0.0))
    if not 0 <= number < 1e6 or number != int(number):
        raise plugin.error(f"<actuator_number> is {number:g}, which is not a whole number from 0")
    plugin.has("motorSpeedPubTopic")  # gz-sim reads it no more
    values: dict[str, Any] = {}
    for tag, (name, default) in _NUMBERS.items():
        values[name] = plugin.number(tag, default)
        if values[name] < 0.0 or (tag in _POSITIVE and values[name] == 0.0):
            what = "above zero" if tag in _POSITIVE else "zero or more"
            raise plugin.error(f"<{tag}> is {values[name]:g}, and has to be {what}")
    return {
        "joints": joint,
        "links": link,
        "actuator_numbers": int(number),
        "turning_directions": _TURNS[turns],
        **values,
    }


def _control(plugin: DrivePlugin) -> dict[str, Any]:
    """Return the parameters of the control of the velocity."""
    link = plugin.link("comLinkName")
    if link != plugin.description.root_link:
        raise CannotWorkError(f"<comLinkName> is {link!r}, and only the root link's velocity can be controlled")
    for tag in ("robotNamespace", *_GAINS):
        if not plugin.has(tag):
            raise CannotWorkError(f"<{tag}> is missing")
    joints = plugin.texts(f"{_ROTOR}/jointName")
    plugin.check_joints(joints)
    forces, moments = plugin.numbers(f"{_ROTOR}/forceConstant"), plugin.numbers(f"{_ROTOR}/momentConstant")
    directions = plugin.numbers(f"{_ROTOR}/direction")
    if not joints or not len(joints) == len(forces) == len(moments) == len(directions):
        raise CannotWorkError("each <rotor> needs a jointName, a forceConstant, a momentConstant and a direction")
    for tag in _NOISE:
        plugin.skip(tag, "0 0 0")
    limits = {name: list(plugin.vector(tag)) for tag, name in _LIMITS.items() if plugin.has(tag)}
    return {
        "com_link": link,
        **{name: list(plugin.vector(tag)) for tag, name in _GAINS.items()},
        **limits,
        "control_joints": list(joints),
        "control_force_constants": list(forces),
        "control_moment_constants": list(moments),
        "control_directions": [int(direction) for direction in directions],
    }
