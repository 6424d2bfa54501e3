"""Four hands: three with the sizes, masses and forces that their makers publish, and the one of the bundled arm.

Of each, one joint is driven and the others follow it. The three close along y, around a point below their link
``hand``. Lengths are in m, angles in rad, masses in kg, forces in N.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin
from pathlib import Path

from scipy.optimize import brentq

PLUGIN = "<hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>"

_LINK = """<link name="{name}"><inertial><origin xyz="{center}"/><mass value="{mass}"/>
<inertia ixx="{moment}" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial>{shape}</link>"""
_PAD = '<collision><origin xyz="{xyz}"/><geometry><box size="{size}"/></geometry></collision>'
_JOINT = """<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
<axis xyz="{axis}"/><origin xyz="{xyz}" rpy="{rpy}"/>
<limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="{velocity}"/>{rest}</joint>"""


def link(name: str, mass: float, center: str = "0 0 0", shape: str = "", side: float = 0.04) -> str:
    """URDF of a link with the moments of a cube."""
    return _LINK.format(name=name, mass=mass, center=center, moment=mass * side**2 / 6, shape=shape)


def joint(kind: str, parent: str, child: str, limits, axis: str, xyz: str, rest: str = "", rpy: str = "0 0 0") -> str:
    """URDF of a joint called after its child, with limits (lower, upper, effort, velocity)."""
    lower, upper, effort, velocity = limits
    return _JOINT.format(**{key: value for key, value in locals().items() if key != "limits"})


@dataclass(frozen=True)
class Hand:
    """A hand, whose pads are as far from the middle as its driven joint's position says.

    Attributes:
        driven: The driven joint.
        half_gap: Its position → how far each pad is from the middle.
        reach: Its position → how far the middle of the pads is from the hand's frame.
        urdf: The links and joints of the hand, but for the bundled one.
        falls: Its position → how fast the pads come down with it where the hand points down.
        mass: The mass that comes down with the pads.
    """

    driven: str
    half_gap: Callable[[float], float]
    reach: Callable[[float], float]
    urdf: str = ""
    falls: Callable[[float], float] = lambda position: 0.0
    mass: float = 0.0

    def closed_to(self, width: float) -> float:
        """Return the position at which the pads touch something of a width."""
        lower, upper = (-0.34, 0.82)
        return float(brentq(lambda position: self.half_gap(position) - width / 2, lower, upper, xtol=1e-12))

    def effort(self, width: float, force: float, drags: float = 0.0) -> float:
        """Return the effort with which each pad squeezes something of a width by a force.

        Args:
            width: The width.
            force: The force.
            drags: Its part with which the thing pulls each pad down.
        """
        at, step = self.closed_to(width), 1e-6
        slope = (self.half_gap(at + step) - self.half_gap(at - step)) / (2 * step)
        return -2 * force * slope - self.falls(at) * (2 * drags * force + 9.81 * self.mass)


def _sliding(mass, finger, pad, reach, limits, damping=0.0) -> Hand:
    """A hand of two fingers that slide."""
    parts = [link("hand", mass, "0 0 -0.03", side=0.08)]
    for name, side in (("left", 1), ("right", -1)):
        shape = _PAD.format(xyz=f"0 {side * pad[1] / 2} 0", size=" ".join(map(str, pad)))
        parts.append(link(name, finger, f"0 {side * pad[1]} 0.02", shape, 0.02))
        rest = f'<dynamics damping="{damping}"/>' + ("" if side > 0 else '<mimic joint="left_joint"/>')
        parts.append(joint("prismatic", "hand", name, limits, f"0 {side} 0", f"0 0 {-reach}", rest))
    return Hand("left_joint", lambda position: position, lambda position: reach, "".join(parts))


# Franka Hand: 0.73 kg, 80 mm of stroke, fingers of 15 g, pads of 18 mm; 70 N for long, 140 N at most.
_PANDA = _sliding(0.73, 0.015, (0.018, 0.015, 0.018), 0.104, (0.0, 0.04, 140.0, 0.2), damping=0.3)

# Schunk WSG 50-110: 1.2 kg, 110 mm of stroke, 80 N; a guide with its finger 0.2 kg, pads of 20 × 30 mm.
_WSG = _sliding(1.2, 0.2, (0.02, 0.012, 0.03), 0.13, (0.0, 0.055, 160.0, 0.2))


def _robotiq() -> Hand:
    """Robotiq 2F-85: 0.9 kg, 85 mm of stroke, 20 to 235 N, pads of 22 × 37 mm.

    On each side two parallel cranks hold a fingertip, which keeps its direction.
    """
    pivot, crank, inner = (0.03, 0.055), (0.037, 0.043), (0.012, 0.061)
    face = pivot[0] + crank[0] - 0.085 / 2  # from the fingertip's joint to its pad
    down = 0.027  # from there to the middle of the pad
    masses = {"crank": 0.055, "inner": 0.03, "tip": 0.045}
    limits = (0.0, 0.82, 50.0, 0.5)
    parts = [link("hand", 0.6, "0 0 -0.03", side=0.08)]
    for name, side in (("left", 1), ("right", -1)):
        end, middle = (f"0 {side * crank[0] * part} {-crank[1] * part}" for part in (1.0, 0.5))
        shape = _PAD.format(xyz=f"0 {-side * (face - 0.005)} {-down}", size="0.022 0.01 0.037")
        parts += [link(f"{name}_{bar}", masses[bar], middle) for bar in ("crank", "inner")]
        parts.append(link(name, masses["tip"], f"0 {-side * 0.015} -0.02", shape, 0.03))
        mimic = '<mimic joint="left_crank_joint"/>'
        for bar, (y, z) in (("crank", pivot), ("inner", inner)):
            child = f"{name}_{bar}"
            rest = "" if child == "left_crank" else mimic
            parts.append(joint("revolute", "hand", child, limits, f"{-side} 0 0", f"0 {side * y} {-z}", rest))
        parts.append(joint("revolute", f"{name}_crank", name, limits, f"{side} 0 0", end, mimic))
    return Hand(
        "left_crank_joint",
        lambda angle: pivot[0] + crank[0] * cos(angle) - crank[1] * sin(angle) - face,
        lambda angle: pivot[1] + crank[1] * cos(angle) + crank[0] * sin(angle) + down,
        "".join(parts),
        lambda angle: crank[0] * cos(angle) - crank[1] * sin(angle),
        2 * (masses["crank"] / 2 + masses["inner"] / 2 + masses["tip"]),
    )


def _pad_of_bundled(angle: float) -> tuple[float, float]:
    """Where the bundled arm's left finger touches (m), from its joint: along it, and towards the other one.

    Its pad is 24 mm long. Where it is turned inwards the pad's tip touches, outwards its root.
    """
    along = 0.086 if abs(angle) < 1e-9 else 0.098 if angle < 0 else 0.074
    return along * cos(angle) + 0.014 * sin(angle), 0.014 * cos(angle) - along * sin(angle)


_BUNDLED = Hand(
    "joint_4",
    lambda angle: 0.045 - _pad_of_bundled(angle)[1],
    lambda angle: 0.024 + _pad_of_bundled(angle)[0],
)

HANDS = {"panda": _PANDA, "robotiq": _robotiq(), "wsg": _WSG, "bundled": _BUNDLED}

# What carries the three: a mount that is lifted, sways, tilts and turns.
MOUNT = ("carriage", "slide", "wrist", "hand")


def on_mount(hand: Hand, height: float) -> str:
    """URDF of a hand that points down, at a height."""
    parts = ['<link name="world"/>', *(link(name, 2.0) for name in MOUNT[:-1])]
    for kind, parent, child, axis, limits in (
        ("prismatic", "world", "carriage", "0 0 1", (-1, 1, 500, 1)),
        ("prismatic", "carriage", "slide", "1 0 0", (-1, 1, 500, 1)),
        ("revolute", "slide", "wrist", "1 0 0", (-1, 1, 100, 3)),
        ("revolute", "wrist", "hand", "0 0 1", (-3, 3, 100, 3)),
    ):
        parts.append(joint(kind, parent, child, limits, axis, f"0 0 {height if parent == 'world' else 0}"))
    return _robot(parts, hand, "velocity", MOUNT)


# Franka's arm: how each joint stands on the one before, in Denavit and Hartenberg's parameters as published.
_FRAMES = (
    ("0 0 0.333", "0 0 0"),
    ("0 0 0", f"{-pi / 2} 0 0"),
    ("0 -0.316 0", f"{pi / 2} 0 0"),
    ("0.0825 0 0", f"{pi / 2} 0 0"),
    ("-0.0825 0.384 0", f"{-pi / 2} 0 0"),
    ("0 0 0", f"{pi / 2} 0 0"),
    ("0.088 0 0", f"{pi / 2} 0 0"),
)
_MASSES = (3.0, 3.0, 3.0, 3.0, 2.5, 2.0, 1.5)  # 18 kg in all
_LIMITS = (
    (-2.9, 2.9, 87, 2.2),
    (-1.76, 1.76, 87, 2.2),
    (-2.9, 2.9, 87, 2.2),
    (-3.07, -0.07, 87, 2.2),
    (-2.9, 2.9, 12, 2.6),
    (-0.02, 3.75, 12, 2.6),
    (-2.9, 2.9, 12, 2.6),
)
ARM_LINKS = tuple(f"arm_{number}" for number in range(1, 8))
READY = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)  # the hand points down


def on_panda_arm(hand: Hand) -> str:
    """URDF of Franka's arm with a hand."""
    parts = ['<link name="world"/>']
    for parent, child, mass, (xyz, rpy), limits in zip(
        ("world", *ARM_LINKS), ARM_LINKS, _MASSES, _FRAMES, _LIMITS, strict=False
    ):
        parts += [link(child, mass, side=0.1), joint("revolute", parent, child, limits, "0 0 1", xyz, rpy=rpy)]
    origin = f'<origin xyz="0 0 0.107" rpy="{pi} 0 {-pi / 4}"/>'
    parts.append(f'<joint name="flange" type="fixed"><parent link="arm_7"/><child link="hand"/>{origin}</joint>')
    return _robot(parts, hand, "position", ARM_LINKS)


def _robot(parts, hand: Hand, interface: str, children) -> str:
    driven = [(f"{child}_joint", interface) for child in children]
    states = "".join(f'<state_interface name="{name}"/>' for name in ("position", "velocity"))
    interfaces = "".join(
        f'<joint name="{name}"><command_interface name="{command}"/>{states}</joint>'
        for name, command in (*driven, (hand.driven, "effort"))
    )
    return f"""<robot name="robot">{"".join(parts)}{hand.urdf}
<ros2_control name="c" type="system">{PLUGIN}{interfaces}</ros2_control></robot>"""


def controllers(folder: Path, hand: Hand, children, kind: str, parameters: str) -> Path:
    """Write the parameters of two controllers: ``carry`` of what carries the hand, and ``grip`` of its effort."""
    file = folder / "controllers.yaml"
    joints = ", ".join(f"{child}_joint" for child in children)
    file.write_text(f"""
controller_manager:
  ros__parameters:
    update_rate: 100
    carry: {{type: {kind}}}
    grip: {{type: forward_command_controller/ForwardCommandController}}
carry: {{ros__parameters: {{joints: [{joints}], {parameters}}}}}
grip: {{ros__parameters: {{joints: [{hand.driven}], interface_name: effort}}}}
""")
    return file
