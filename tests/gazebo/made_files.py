"""URDF and SDF files that are made up from a seed, with what decides where Gazebo has links, shapes and sensors.

A file follows from its seed for good: it rests on `Random.random` alone, whose sequence no version of Python changes.
"""

from collections.abc import Callable, Sequence
from random import Random
from typing import TypeVar

T = TypeVar("T")

# Some names begin with another one's, by which libsdformat tells whose a shape is.
LINKS = ("base", "base_link", "arm", "arm_tip", "wheel", "hub", "hub_cap", "mast", "skid", "base_link_skid")
GEOMETRIES = ('<box size="0.3 0.2 0.1"/>', '<sphere radius="0.1"/>', '<cylinder radius="0.1" length="0.2"/>')
INERTIA = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
SDF_INERTIA = "<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>"


class Dice:
    """Choices that follow from a seed."""

    def __init__(self, seed: int):
        self._random = Random(seed).random

    def number(self, low: float, high: float, digits: int = 3) -> float:
        """Return a number with few digits."""
        return round(low + (high - low) * self._random(), digits)

    def numbers(self, count: int, low: float, high: float) -> str:
        """Return numbers as XML has them."""
        return " ".join(f"{self.number(low, high):g}" for _ in range(count))

    def one(self, items: Sequence[T]) -> T:
        """Return an item."""
        return items[int(self._random() * len(items))]

    def some(self, items: Sequence[T], count: int) -> list[T]:
        """Return so many different items."""
        left = list(items)
        return [left.pop(int(self._random() * len(left))) for _ in range(count)]

    def often(self, share: float = 0.5) -> bool:
        """Return true so often."""
        return self._random() < share

    def pose(self) -> str:
        """Return the numbers of a ``<pose>``, whose pitch is below 90 degrees."""
        return f"{self.numbers(3, -1, 1)} {self.numbers(3, -1.4, 1.4)}"


# --- URDF


def urdf(seed: int) -> str:
    """Make a robot with fixed and moving joints, named and unnamed shapes, surfaces, limits and sensors."""
    dice = Dice(seed)
    names = dice.some(LINKS, 2 + int(dice.number(0, 6)))
    parts = [_link(dice, name, is_root=name == names[0]) for name in names]
    for index, child in enumerate(names[1:]):
        parts.append(_joint(dice, dice.one(("z", "a", "m")) + f"_{index}", dice.one(names[: index + 1]), child))
    for name in names:
        parts += [_surface(dice, name) for _ in range(int(dice.number(0, 2.4)))]
        if dice.often(0.3):
            parts.append(_sensor(dice, name))
    return f'<robot name="made_{seed}">\n' + "\n".join(parts) + "\n</robot>\n"


def _link(dice: Dice, name: str, *, is_root: bool) -> str:
    inertial = f'<inertial><origin xyz="{dice.numbers(3, -0.1, 0.1)}"/><mass value="1"/>{INERTIA}</inertial>'
    shapes = "".join(_shape(dice, name) for _ in range(int(dice.number(0, 3.4))))
    return f'<link name="{name}">{inertial}{shapes}</link>'


def _shape(dice: Dice, link: str) -> str:
    name = dice.one(("", "", "", "tyre", f"{link}_rim", link, "hull"))
    called = f' name="{name}"' if name else ""
    return f"<collision{called}>{_origin(dice)}<geometry>{dice.one(GEOMETRIES)}</geometry></collision>"


def _origin(dice: Dice) -> str:
    if dice.often(0.2):
        return ""
    return f'<origin xyz="{dice.numbers(3, -1, 1)}" rpy="{dice.numbers(3, -1.4, 1.4)}"/>'


def _joint(dice: Dice, name: str, parent: str, child: str) -> str:
    kind = dice.one(("fixed", "fixed", "revolute", "continuous", "prismatic"))
    inside = _origin(dice)
    if kind != "fixed":
        inside += f'<axis xyz="{dice.one(("1 0 0", "0 -1 0", "0 0 2", "1 1 0", "0.6 0 -0.8"))}"/>'
        bounds = f'lower="{dice.number(-3, 0):g}" upper="{dice.number(0, 3):g}" ' if kind != "continuous" else ""
        effort, velocity = (dice.one(("7.5", "1e9", "-1", "0.25")) for _ in range(2))
        if kind != "continuous" or dice.often():
            inside += f'<limit {bounds}effort="{effort}" velocity="{velocity}"/>'
        if dice.often():
            inside += f'<dynamics damping="{dice.number(0, 1):g}" friction="{dice.number(0, 1):g}"/>'
    joint = f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'
    if kind == "fixed" and dice.often(0.3):
        kept = dice.one(("true", "false"))
        joint += f'<gazebo reference="{name}"><preserveFixedJoint>{kept}</preserveFixedJoint></gazebo>'
    return joint


def _surface(dice: Dice, link: str) -> str:
    inside = f"<mu1>{dice.number(0, 2):g}</mu1>" if dice.often(0.7) else ""
    inside += f'<mu2 value="{dice.number(0, 2):g}"/>' if dice.often() else ""
    if dice.often(0.3):
        coefficients = f"<mu>{dice.number(0, 2):g}</mu>" + (f"<mu2>{dice.number(0, 2):g}</mu2>" if dice.often() else "")
        inside += f"<collision><surface><friction><ode>{coefficients}</ode></friction></surface></collision>"
    inside += f"<selfCollide>{dice.one(('true', 'false'))}</selfCollide>" if dice.often(0.2) else ""
    return f'<gazebo reference="{link}">{inside}</gazebo>'


def _sensor(dice: Dice, link: str) -> str:
    pose = f"<pose>{dice.pose()}</pose>" if dice.often(0.7) else ""
    rate = f"<update_rate>{dice.number(1, 100, 0):g}</update_rate>"
    topic = f"<topic>{dice.one(('imu', '/up', 'a/b'))}</topic>" if dice.often() else ""
    kind = dice.one(("imu", "gpu_lidar", "altimeter"))
    return (
        f'<gazebo reference="{link}"><sensor name="{link}_sensor" type="{kind}">{pose}{topic}{rate}</sensor></gazebo>'
    )


# --- SDF


def sdf_robot(seed: int) -> str:
    """Make a model whose poses are relative to links, joints and frames, as a robot's file."""
    dice = Dice(seed)
    return f'<sdf version="1.9">\n{_model(dice, f"made_{seed}", is_tree=True)}\n</sdf>\n'


def sdf_world(seed: int) -> dict[str, str]:
    """Make a world, with the files of the model that it includes: path → text."""
    dice = Dice(seed)
    names = [f"model_{index}" for index in range(2 + int(dice.number(0, 3)))]
    parts, known = [], ["world"]
    for name in names:
        if dice.often(0.3):
            frame = f"frame_of_{name}"
            attached = f' attached_to="{dice.one(known)}"' if dice.often() else ""
            parts.append(f'<frame name="{frame}"{attached}>{_pose(dice, known)}</frame>')
            known.append(frame)
        if dice.often(0.4):
            pose = _pose(dice, known) if dice.often(0.8) else ""
            placed = "<placement_frame>grip</placement_frame>" if pose and dice.often(0.4) else ""
            parts.append(f"<include><name>{name}</name><uri>model://part</uri>{placed}{pose}</include>")
        else:
            parts.append(_model(dice, name, is_tree=dice.often(), known=known, nested=dice.often(0.3)))
        known += [name, f"{name}::link_0"]
    body = "\n".join(parts)
    frame = f'<frame name="grip" attached_to="link_0">{_pose(dice, ())}</frame>'
    part = _model(Dice(seed + 1), "part", is_tree=True, more=frame)
    return {
        "made.sdf": f'<sdf version="1.9"><world name="made">\n{body}\n</world></sdf>\n',
        "part/model.sdf": f'<sdf version="1.9">\n{part}\n</sdf>\n',
        "part/model.config": '<model><name>part</name><sdf version="1.9">model.sdf</sdf></model>\n',
    }


def sdf_merged(seed: int) -> dict[str, str]:
    """Make a robot that takes a part by merging, with the part's file: path → text."""
    dice = Dice(seed)
    frame = f'<frame name="grip" attached_to="link_0">{_pose(dice, ())}</frame>'
    part = f"{_pose(dice, ())}{frame}"
    pose = _pose(dice, ()) if dice.often(0.8) else ""
    placed = "<placement_frame>grip</placement_frame>" if pose and dice.often() else ""
    include = f'<include merge="true"><uri>model://part</uri>{placed}{pose}</include>'
    own = f'<link name="own">{_pose(dice, ("link_0", "grip"))}<inertial><mass>1</mass>{SDF_INERTIA}</inertial></link>'
    joint = _sdf_joint(dice, "mount", "link_0", "own", ("link_0", "grip", "own"))
    body = "\n".join((include, own, joint))
    return {
        "made.sdf": f'<sdf version="1.9"><model name="made">\n{body}\n</model></sdf>\n',
        "part/model.sdf": f'<sdf version="1.9">\n{_model(dice, "part", is_tree=True, more=part)}\n</sdf>\n',
        "part/model.config": '<model><name>part</name><sdf version="1.9">model.sdf</sdf></model>\n',
    }


def _model(
    dice: Dice, name: str, *, is_tree: bool, known: Sequence[str] = (), nested: bool = False, more: str = ""
) -> str:
    links = [f"link_{index}" for index in range(1 + int(dice.number(0, 4)))]
    frames: list[str] = []
    parts, joints = [], []
    for index, link in enumerate(links):
        if dice.often(0.4):
            frame = f"frame_{index}"
            attached = f' attached_to="{dice.one(links[:index])}"' if index and dice.often() else ""
            parts.append(f'<frame name="{frame}"{attached}>{_pose(dice, (*links[:index], *frames))}</frame>')
            frames.append(frame)
        shapes = "".join(_sdf_shape(dice, f"shape_{each}", frames) for each in range(int(dice.number(0, 2.5))))
        sensor = f'<sensor name="{link}_sensor" type="imu">{_pose(dice, frames)}</sensor>' if dice.often(0.3) else ""
        inertial = f"<inertial><mass>1</mass>{SDF_INERTIA}</inertial>"
        parts.append(f'<link name="{link}">{_pose(dice, (*links[:index], *frames))}{inertial}{shapes}{sensor}</link>')
        if index and is_tree:
            joints.append(_sdf_joint(dice, f"joint_{index}", dice.one(links[:index]), link, (*links, *frames)))
    for joint in (f"joint_{index}" for index in range(1, len(links)) if is_tree):
        if dice.often(0.3):
            frame, held = f"frame_of_{joint}", f"held_by_{joint}"
            parts.append(f'<frame name="{frame}" attached_to="{joint}">{_pose(dice, ())}</frame>')
            inertial = f"<inertial><mass>1</mass>{SDF_INERTIA}</inertial>"
            parts.append(f'<link name="{held}">{_pose(dice, (frame,))}{inertial}</link>')
            ends = f"<parent>{joint}</parent><child>{held}</child>"
            joints.append(f'<joint name="holds_{held}" type="fixed">{ends}</joint>')
            frames.append(frame)
    if nested:
        parts.append(_model(dice, "inner", is_tree=True, known=(*links, *frames)))
    static = f"<static>{dice.one(('true', 'false'))}</static>" if known and name != "inner" and not nested else ""
    holds = (
        *links,
        *frames,
        *(f"joint_{index}" for index in range(1, len(links)) if is_tree),
        *(["inner"] if nested else ()),
    )
    placed = f' placement_frame="{dice.one(holds)}"' if dice.often(0.3) else ""
    pose = _pose(dice, known) if dice.often(0.8) else ""
    return f'<model name="{name}"{placed}>{static}{pose}{more}' + "\n".join((*parts, *joints)) + "</model>"


def _sdf_joint(dice: Dice, name: str, parent: str, child: str, known: Sequence[str]) -> str:
    kind = dice.one(("fixed", "revolute", "continuous", "prismatic"))
    inside = f"<parent>{parent}</parent><child>{child}</child>" + (_pose(dice, known) if dice.often(0.6) else "")
    if kind != "fixed":
        within = f' expressed_in="{dice.one(known)}"' if dice.often() else ""
        bounds = f"<lower>{dice.number(-3, 0):g}</lower><upper>{dice.number(0, 3):g}</upper>" if dice.often(0.7) else ""
        bounds = "" if kind == "continuous" else bounds
        bounds += f"<effort>{dice.number(1, 9):g}</effort>" if dice.often() else ""
        bounds += f"<velocity>{dice.number(1, 9):g}</velocity>" if dice.often() else ""
        axis = dice.one(("1 0 0", "0 -1 0", "0 0 2", "1 1 0"))
        dynamics = f"<damping>{dice.number(0, 1):g}</damping>" if dice.often() else ""
        dynamics += f"<friction>{dice.number(0, 1):g}</friction>" if dice.often() else ""
        inside += f"<axis><xyz{within}>{axis}</xyz><limit>{bounds}</limit><dynamics>{dynamics}</dynamics></axis>"
    return f'<joint name="{name}" type="{kind}">{inside}</joint>'


def _sdf_shape(dice: Dice, name: str, known: Sequence[str]) -> str:
    coefficients = f"<mu>{dice.number(0, 2):g}</mu>" if dice.often() else ""
    coefficients += f"<mu2>{dice.number(0, 2):g}</mu2>" if dice.often() else ""
    surface = f"<surface><friction><ode>{coefficients}</ode></friction></surface>" if dice.often() else ""
    geometry = dice.one(("<box><size>0.3 0.2 0.1</size></box>", "<sphere><radius>0.1</radius></sphere>"))
    return f'<collision name="{name}">{_pose(dice, known)}<geometry>{geometry}</geometry>{surface}</collision>'


def _pose(dice: Dice, known: Sequence[str]) -> str:
    """Return a ``<pose>`` in one of SDF's forms, relative to something known or to what it is in."""
    to = f' relative_to="{dice.one(known)}"' if known and dice.often(0.4) else ""
    form = dice.one(("", "", "degrees", "quaternion"))
    if form == "quaternion":
        quaternion = dice.one(("0 0 0.6 0.8", "0.6 0 0 0.8", "0 -0.28 0 0.96"))
        return f'<pose{to} rotation_format="quat_xyzw">{dice.numbers(3, -1, 1)} {quaternion}</pose>'
    if form == "degrees":
        return f'<pose{to} degrees="true">{dice.numbers(3, -1, 1)} {dice.numbers(3, -80, 80)}</pose>'
    return f"<pose{to}>{dice.pose()}</pose>"


MAKERS: dict[str, Callable[[int], dict[str, str]]] = {
    "urdf": lambda seed: {"made.urdf": urdf(seed)},
    "sdf": lambda seed: {"made.sdf": sdf_robot(seed)},
    "world": sdf_world,
    "merged": sdf_merged,
}
