"""Actuators and joints of an MJCF robot as MuJoCo drives them: motors, servos, armature, dry friction and springs."""

from collections.abc import Iterator, Mapping
from math import inf, radians

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.mjcf_defaults import MjcfDefaults
from drake_twin.description.robot_description import (
    MUJOCO,
    CommandInterface,
    ControlledJoint,
    HardwareSystem,
    StateInterface,
)
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Finding, Kind, at_places

_SERVOS = ("motor", "position", "velocity", "general")
_STATES = (StateInterface("position"), StateInterface("velocity"), StateInterface("effort"))
_UNREAD = ("actdim", "actlimited", "actrange", "actearly", "lengthrange", "cranklength", "inheritrange", "user")


@dataclass(frozen=True)
class MjcfJoint:
    """What the twin, and not Drake's parser, reads of a hinge or a slide.

    Attributes:
        armature: The inertia that its actuator adds (kg·m² or kg).
        friction: Its ``frictionloss`` (N·m or N).
        stiffness: The stiffness of its spring (N·m/rad or N/m).
        rest: The position at which its spring is at rest (rad or m).
        effort: The largest effort of its actuators, ``actuatorfrcrange`` (N·m or N).
    """

    armature: float = 0.0
    friction: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    effort: float = inf


@dataclass(frozen=True)
class _Drive:
    """An actuator at its joint: the interface, its bounds (rad, rad/s, N·m or m, m/s, N), gains and largest effort."""

    command: CommandInterface
    kp: float = 0.0
    kv: float = 0.0
    effort: float = inf


class MjcfActuators:
    """The actuators of an MJCF robot, and what of its joints belongs to them.

    A motor takes efforts, a position servo positions and a velocity servo velocities *of the joint*: MuJoCo's ``ctrl``
    is in units of the actuator, and the joint's value is ctrl · gear (effort) or ctrl / gear (position, velocity). With
    the gear g a servo's effort at the joint is g²·kp·(command − q) − g²·kv·q̇, at most g·``forcerange``
    (https://mujoco.readthedocs.io/en/stable/XMLreference.html#actuator-position).

    Attributes:
        joints: The name of each hinge and slide → what is read of it.
        systems: What of the robot can be commanded.
        efforts: Joint → the largest effort of its actuator (N·m or N).
        findings: What cannot be had.

    Raises:
        InputError: If a value is not a number, a gain is negative, or an actuator names a joint that is not there.
    """

    def __init__(self, reader: XmlReader):
        self._reader = reader
        compiler = reader.root.find("compiler")
        settings: Mapping[str, str] = {} if compiler is None else {str(k): str(v) for k, v in compiler.attrib.items()}
        self._autolimits = settings.get("autolimits", "true") == "true"
        self._in_degrees = settings.get("angle", "degree") == "degree"
        self._defaults = MjcfDefaults(reader.root)
        self._lost: list[tuple[str, etree._Element]] = []
        self.joints = dict(self._read_joints())
        drives = dict(self._read_actuators())
        self.efforts = {
            name: min(drive.effort, self.joints[name].effort if name in self.joints else inf)
            for name, drive in drives.items()
        }
        for joint in (item for body in reader.root.iterfind("worldbody/body") for item in body.iter("joint")):
            name = joint.get("name", "")
            if name not in drives and self.joints.get(name, MjcfJoint()).armature:
                self._lost.append(("armature of a <joint> without an actuator", joint))
        controlled = tuple(
            ControlledJoint(name, (drive.command,), _STATES, {"kp": repr(drive.kp), "kv": repr(drive.kv)})
            for name, drive in drives.items()
        )
        self.systems = (HardwareSystem("actuator", "system", MUJOCO, controlled),) if controlled else ()
        self.findings: tuple[Finding, ...] = tuple(
            at_places(Kind.IGNORED, ((what, reader.place(element)) for what, element in self._lost))
        )

    def _read_joints(self) -> Iterator[tuple[str, MjcfJoint]]:
        for joint in (item for body in self._reader.root.iterfind("worldbody/body") for item in body.iter("joint")):
            values = self._defaults.of_joint(joint)
            # Drake's parser loses the values of a class above one that has none for joints.
            joint.attrib.update({name: value for name, value in values.items() if name != "class"})
            kind = values.get("type", "hinge")
            if kind not in ("hinge", "slide") or not joint.get("name"):
                whose = "a <joint> without a name" if kind in ("hinge", "slide") else f"a {kind} <joint>"
                for name in ("armature", "frictionloss", "stiffness"):
                    if self._positive(joint, values, name):
                        self._lost.append((f"{name} of {whose}", joint))
                continue
            angle = kind == "hinge" and self._in_degrees
            rest = self._number(joint, values, "springref", 0.0)
            if self._number(joint, values, "ref", 0.0):
                self._lost.append(("ref of a <joint>", joint))
            _, effort = self._range(joint, values, "actuatorfrc") or (0.0, inf)
            yield (
                joint.get("name", ""),
                MjcfJoint(
                    self._positive(joint, values, "armature"),
                    self._positive(joint, values, "frictionloss"),
                    self._positive(joint, values, "stiffness"),
                    radians(rest) if angle else rest,
                    effort,
                ),
            )

    def _read_actuators(self) -> Iterator[tuple[str, _Drive]]:
        driven = set()
        for actuator in (item for group in self._reader.root.findall("actuator") for item in group):
            if not isinstance(actuator.tag, str):
                continue
            values = self._defaults.of_actuator(actuator)
            joint = values.get("joint")
            if actuator.tag not in _SERVOS:
                self._lost.append((f"<{actuator.tag}> of <actuator>", actuator))
                continue
            if joint is None:
                where = next(
                    (item for item in ("jointinparent", "tendon", "site", "body") if item in values), "nothing"
                )
                self._lost.append((f"<{actuator.tag}> that drives a {where}", actuator))
                continue
            if joint not in self.joints:
                known = ", ".join(name for name in self.joints if name) or "none"
                what = f"joint is {joint!r}, which is not a hinge or slide of the robot; it has: {known}"
                raise self._reader.error(actuator, what)
            if joint in driven:
                self._lost.append(("second actuator of a joint", actuator))
                continue
            drive = self._drive(actuator, values)
            if drive is not None:
                driven.add(joint)
                yield joint, drive

    def _drive(self, actuator: etree._Element, values: Mapping[str, str]) -> _Drive | None:
        """Return an actuator at its joint; None, and what is lost, if the twin has nothing like it."""
        gear = self._reader.parse_number(actuator, next(iter(values.get("gear", "1").split()), "1"), "gear")
        if values.get("dyntype", "none") != "none" or self._number(actuator, values, "timeconst", 0.0):
            self._lost.append((f"<{actuator.tag}> with activation dynamics", actuator))
            return None
        self._lost += [(f"{name} of <{actuator.tag}>", actuator) for name in _UNREAD if name in values]
        gain, constant, by_position, by_velocity = self._gain_and_bias(actuator, values)
        if not gear or not gain:
            self._lost.append((f"<{actuator.tag}> without an effect: its gain or gear is 0", actuator))
            return None
        lower, upper = self._range(actuator, values, "ctrl") or (-inf, inf)
        weakest, strongest = self._range(actuator, values, "force") or (-inf, inf)
        kp, kv, effort = -by_position * gear**2, -by_velocity * gear**2, abs(gear) * max(abs(weakest), abs(strongest))
        if not by_position and not by_velocity and not constant:
            ends = sorted(gear * min(max(gain * end, weakest), strongest) for end in (lower, upper))
            return _Drive(CommandInterface("effort", *ends), effort=effort)
        if kp < 0 or kv < 0 or not (by_position or by_velocity == -gain) or (constant and not by_position):
            self._lost.append((f"<{actuator.tag}> whose bias is neither a position's nor a velocity's", actuator))
            return None
        if weakest != -strongest:
            self._lost.append((f"difference of the two ends of forcerange of <{actuator.tag}>", actuator))
        if not by_position:
            return _Drive(CommandInterface("velocity", *sorted((lower / gear, upper / gear))), 0.0, kv, effort)
        ends = sorted((gain * end + constant) / (-by_position * gear) for end in (lower, upper))
        return _Drive(CommandInterface("position", *ends), kp, kv, effort)

    def _gain_and_bias(self, actuator: etree._Element, values: Mapping[str, str]) -> tuple[float, float, float, float]:
        """Return g, a, b, c of the actuator's force g·ctrl + a + b·length + c·velocity."""
        if actuator.tag == "motor":
            return 1.0, 0.0, 0.0, 0.0
        if actuator.tag == "velocity":
            kv = self._positive(actuator, values, "kv", 1.0)
            return kv, 0.0, 0.0, -kv
        if actuator.tag == "position":
            kp = self._positive(actuator, values, "kp", 1.0)
            if self._number(actuator, values, "dampratio", 0.0):
                self._lost.append(("dampratio of <position>", actuator))
            return kp, 0.0, -kp, -self._positive(actuator, values, "kv")
        gain = self._first(actuator, values, "gainprm", (1.0, 0.0, 0.0))
        bias = self._first(actuator, values, "biasprm", (0.0, 0.0, 0.0))
        kinds = values.get("gaintype", "fixed"), values.get("biastype", "none")
        if kinds[0] != "fixed" or kinds[1] not in ("none", "affine"):
            return 0.0, 0.0, 0.0, 0.0
        return gain[0], *(bias if kinds[1] == "affine" else (0.0, 0.0, 0.0))

    def _first(
        self, element: etree._Element, values: Mapping[str, str], name: str, default: tuple[float, float, float]
    ) -> tuple[float, float, float]:
        given = [self._reader.parse_number(element, part, name) for part in values.get(name, "").split()][:3]
        first, second, third = (*given, *default[len(given) :])
        return first, second, third

    def _number(self, element: etree._Element, values: Mapping[str, str], name: str, default: float) -> float:
        return self._reader.parse_number(element, values[name], name) if name in values else default

    def _positive(self, element: etree._Element, values: Mapping[str, str], name: str, default: float = 0.0) -> float:
        number = self._number(element, values, name, default)
        if number < 0:
            raise self._reader.error(element, f"{name} is {number:g}, and it cannot be negative")
        return number

    def _range(self, element: etree._Element, values: Mapping[str, str], what: str) -> tuple[float, float] | None:
        """Return a range that applies: ``ctrllimited`` says so, or by default that there is a ``ctrlrange``."""
        text = values.get(f"{what}range")
        limited = values.get(f"{what}limited", "auto")
        if text is None or limited == "false" or (limited == "auto" and not self._autolimits):
            return None
        lower, upper = self._reader.parse_numbers(element, text, f"{what}range", 2)
        if not lower < upper:
            raise self._reader.error(element, f"{what}range is {text!r}, where the first must be less than the second")
        return lower, upper
