"""A quadcopter of gz-sim's systems, as SDF, with numbers of which mechanics knows the outcome."""

from collections.abc import Sequence
from math import sqrt

from drake_twin.messages.interface_types import make

G = 9.81
MASS = 1.52  # kg, with the rotors
K, MOMENT, DRAG, ROLL = 8.54858e-06, 0.016, 8.06428e-05, 1e-06
UP, DOWN = 0.0125, 0.025  # s
HOVER = sqrt(MASS * G / 4 / K)  # rad/s
INERTIA = (0.035, 0.07, 0.098)  # kg·m², of the base
ROTORS = (("ccw", 0.13, -0.22), ("ccw", -0.13, 0.2), ("cw", 0.13, 0.22), ("cw", -0.13, -0.2))
_SPIN = "<axis><xyz>0 0 1</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis>"


def inertial(mass: float, moments: Sequence[float]) -> str:
    """SDF of an inertia about its principal axes."""
    own = "".join(f"<i{axis}{axis}>{value}</i{axis}{axis}>" for axis, value in zip("xyz", moments, strict=True))
    return f"<inertial><mass>{mass}</mass><inertia>{own}<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"


def motor(number: int, direction: str, **elements: object) -> str:
    """SDF of a rotor's system."""
    values = {
        "robotNamespace": "X3",
        "jointName": f"rotor_{number}_joint",
        "linkName": f"rotor_{number}",
        "turningDirection": direction,
        "timeConstantUp": UP,
        "timeConstantDown": DOWN,
        "maxRotVelocity": 800.0,
        "motorConstant": K,
        "momentConstant": MOMENT,
        "commandSubTopic": "command/motor_speed",
        "actuator_number": number,
        "rotorDragCoefficient": DRAG,
        "rollingMomentCoefficient": ROLL,
        "rotorVelocitySlowdownSim": 10,
        "motorType": "velocity",
    } | elements
    own = "".join(f"<{tag}>{value}</{tag}>" for tag, value in values.items())
    name = "gz::sim::systems::MulticopterMotorModel"
    return f'<plugin filename="gz-sim-multicopter-motor-model-system" name="{name}">{own}</plugin>'


def control() -> str:
    """SDF of the system that controls the velocity."""
    rotors = "".join(
        f"<rotor><jointName>rotor_{number}_joint</jointName><forceConstant>{K}</forceConstant>"
        f"<momentConstant>{MOMENT}</momentConstant><direction>{1 if direction == 'ccw' else -1}</direction></rotor>"
        for number, (direction, _, _) in enumerate(ROTORS)
    )
    return f"""<plugin filename="gz-sim-multicopter-control-system"
name="gz::sim::systems::MulticopterVelocityControl"><robotNamespace>X3</robotNamespace>
<commandSubTopic>command/twist</commandSubTopic><enableSubTopic>enable</enableSubTopic>
<comLinkName>base_link</comLinkName><velocityGain>2.7 2.7 2.7</velocityGain><attitudeGain>2 3 0.15</attitudeGain>
<angularRateGain>0.4 0.52 0.18</angularRateGain><maximumLinearAcceleration>2 2 2</maximumLinearAcceleration>
<rotorConfiguration>{rotors}</rotorConfiguration></plugin>"""


def quadcopter(
    *, controlled: bool = False, plugins: str | None = None, spin_inertia: float = 4e-5, **elements: object
) -> str:
    """SDF of the quadcopter; ``spin_inertia`` is a rotor's about its axis, ``elements`` are of all rotors' systems."""
    parts = [f'<link name="base_link">{inertial(MASS - 0.02, INERTIA)}</link>']
    for number, (_, x, y) in enumerate(ROTORS):
        moments = (1e-6, spin_inertia, spin_inertia)
        parts.append(
            f'<link name="rotor_{number}"><pose>{x} {y} 0.02 0 0 0</pose>{inertial(0.005, moments)}</link>'
            f'<joint name="rotor_{number}_joint" type="revolute"><parent>base_link</parent>'
            f"<child>rotor_{number}</child>{_SPIN}</joint>"
        )
    if plugins is None:
        plugins = "".join(motor(number, direction, **elements) for number, (direction, _, _) in enumerate(ROTORS))
    parts += [plugins, control() if controlled else ""]
    return f'<sdf version="1.9"><model name="x3">{"".join(parts)}</model></sdf>'


def speeds(*values: float) -> object:
    """A message with the speeds of the rotors (rad/s)."""
    return make("actuator_msgs/msg/Actuators", {"velocity": list(values)})
