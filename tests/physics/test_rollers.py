"""Bases on wheels that carry rollers, each on a joint of its own: they drive as mechanics says."""

from itertools import product
from math import acos, atan2, cos, pi, sin, sqrt

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Ellipsoid
from scenes import Scene, every_engine, plane

RADIUS, ROLLER, COUNT = 0.1, 0.0225, 10  # of a wheel and of the middle of its rollers (m)
AHEAD, ASIDE = 0.3, 0.25  # of the wheels from the middle of the base (m)
APART = RADIUS - ROLLER
SPEED = 4.0  # of the wheels (rad/s)
WHEELS = list(product(("front", "rear"), ("left", "right")))
NAMES = [f"{end}_{side}" for end, side in WHEELS]
CONTROLLERS = f"""
controller_manager:
  ros__parameters:
    update_rate: 100
    wheels: {{type: forward_command_controller/ForwardCommandController}}
wheels: {{ros__parameters: {{joints: [{", ".join(f"{name}_joint" for name in NAMES)}], interface_name: velocity}}}}
"""
LINK = """<link name="{name}"><inertial><mass value="{mass}"/>
<inertia ixx="{across}" iyy="{across}" izz="{along}" ixy="0" ixz="0" iyz="0"/></inertial>{shape}</link>
<joint name="{name}_joint" type="continuous"><parent link="{parent}"/><child link="{name}"/>
<origin xyz="{xyz}" rpy="0 {pitch} {yaw}"/><axis xyz="{axis}"/><limit effort="20" velocity="50"/></joint>"""


def barrel(folder, skew):
    """A mesh of a roller that reaches as far from the wheel's axis everywhere, and half its length (m)."""
    half = APART * np.tan(pi / COUNT) / sin(skew)
    along = np.linspace(-half, half, 13)
    around = np.linspace(0, 2 * pi, 24, endpoint=False)
    radii = RADIUS - np.hypot(APART, along * sin(skew))
    points = [(r * cos(a), r * sin(a), z) for z, r in zip(along, radii, strict=True) for a in around]
    trimesh.convex.convex_hull(points).export(folder / "roller.stl")
    return f'<mesh filename="file://{folder}/roller.stl"/>', half


def rollers(wheel, shape, half, skew, mass=0.05):
    """The rollers around the y axis of a link; the lowest one turns by an angle from that axis."""
    across, along = mass * (3 * ROLLER**2 + (2 * half) ** 2) / 12, mass * ROLLER**2 / 2
    for number in range(COUNT):
        angle = 2 * pi * number / COUNT
        x, y, z = cos(angle) * sin(skew), cos(skew), sin(angle) * sin(skew)
        place = f"{APART * sin(angle)} 0 {-APART * cos(angle)}"
        turn = {"xyz": place, "pitch": acos(z), "yaw": atan2(y, x), "axis": "0 0 1", "mass": mass}
        collision = f"<collision><geometry>{shape}</geometry></collision>"
        yield LINK.format(name=f"{wheel}_{number}", parent=wheel, shape=collision, across=across, along=along, **turn)


def mecanum(folder, kind, degrees=45):
    """URDF of a base on four wheels."""
    skew = np.radians(degrees)
    shape, half = barrel(folder, skew)
    if kind == "cylinder":
        shape = f'<cylinder radius="{ROLLER}" length="{2 * half}"/>'
    parts = [
        """<robot name="base"><link name="chassis"><inertial><mass value="10"/>
<inertia ixx="0.15" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    ]
    for (end, side), name in zip(WHEELS, NAMES, strict=True):
        x, y = AHEAD if end == "front" else -AHEAD, ASIDE if side == "left" else -ASIDE
        place = {"xyz": f"{x} {y} 0", "pitch": 0, "yaw": 0, "axis": "0 1 0", "parent": "chassis", "shape": ""}
        parts.append(LINK.format(name=name, mass=0.5, across=0.002, along=0.002, **place))
        parts += rollers(name, shape, half, -skew if x * y > 0 else skew)
    commanded = "".join(
        f'<joint name="{name}_joint"><command_interface name="velocity"/><state_interface name="position"/></joint>'
        for name in NAMES
    )
    plugin = "<hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>"
    parts.append(f'<ros2_control name="c" type="system">{plugin}{commanded}</ros2_control></robot>')
    return "".join(parts)


def ways(twin, signs, seconds=2.0):
    """How far a base goes ahead, aside and around while its wheels turn at a speed, in metres at the rims."""
    twin.publish("/base/wheels/commands", [SPEED * sign for sign in signs])
    twin.advance_to(twin.time + 0.7)
    found, end = np.zeros(3), twin.time + seconds
    before = twin.entities.state("base")
    while twin.time < end - 1e-9:
        twin.advance_to(twin.time + 0.02)
        after = twin.entities.state("base")
        moved = np.subtract(after.position, before.position)
        yaw, then = (2 * atan2(state.orientation[3], state.orientation[0]) for state in (before, after))
        turned = (then - yaw + pi) % (2 * pi) - pi
        found += (
            moved[0] * cos(yaw) + moved[1] * sin(yaw),
            moved[1] * cos(yaw) - moved[0] * sin(yaw),
            turned * (AHEAD + ASIDE),
        )
        assert abs(after.position[2] - RADIUS) < 1e-3  # it does not bounce
        before = after
    return found / (RADIUS * SPEED * seconds)


@pytest.mark.parametrize("kind", ["mesh", "cylinder"])
@every_engine
def test_a_mecanum_base_with_rollers_drives_slides_sideways_and_turns(figure, tmp_path, engine, kind):
    """A roller that the ground touches beside its middle, by an angle about the wheel, slides by its cosine less."""
    (tmp_path / "controllers.yaml").write_text(CONTROLLERS)
    scene = Scene(tmp_path, engine, plane())
    twin = scene.add("base", mecanum(tmp_path, kind), (0, 0, RADIUS), controllers=tmp_path / "controllers.yaml").build()
    assert {shape.touches for shape in twin.built.shapes if shape.model == "base"} == {"wheel"}
    twin.advance_to(0.3)
    ahead, aside, around = ways(twin, (1, 1, 1, 1))
    assert figure("mecanum base with rollers: forward ÷ kinematic", ahead) == pytest.approx(1, abs=0.002)
    assert [aside, around] == pytest.approx([0, 0], abs=0.002)
    ahead, aside, around = ways(twin, (-1, 1, 1, -1))
    assert figure("mecanum base with rollers: sideways ÷ kinematic", aside) == pytest.approx(
        sin(pi / COUNT) / (pi / COUNT), abs=0.004
    )
    assert [ahead, around] == pytest.approx([0, 0], abs=0.002)
    ahead, aside, around = ways(twin, (-1, 1, -1, 1))
    assert figure("mecanum base with rollers: turning ÷ kinematic", around) == pytest.approx(1, abs=0.03)
    assert [ahead, aside] == pytest.approx([0, 0], abs=0.005)


def test_the_rollers_of_an_omni_wheel_are_alike_where_they_stand_upright(tmp_path):
    twin = Scene(tmp_path, "10ms").add("base", mecanum(tmp_path, "mesh", degrees=90), (0, 0, RADIUS)).build()
    lengths = [shape.shape.c() for shape in twin.built.shapes if isinstance(shape.shape, Ellipsoid)]
    assert len(lengths) == 4 * COUNT
    # The barrel's curvature in its middle; it is closer to the ground beside it.
    assert lengths == pytest.approx([sqrt(ROLLER * (ROLLER + APART))] * len(lengths), rel=0.06)


def test_two_links_on_a_wheel_are_not_rollers(tmp_path):
    urdf = mecanum(tmp_path, "cylinder")
    for name, number in product(NAMES, range(2, COUNT)):
        joint = f'<joint name="{name}_{number}_joint" type='
        urdf = urdf.replace(f'{joint}"continuous"', f'{joint}"fixed"')
    twin = Scene(tmp_path, "10ms").add("base", urdf, (0, 0, RADIUS)).build()
    lengths = [shape.shape.c() for shape in twin.built.shapes if isinstance(shape.shape, Ellipsoid)]
    assert lengths == pytest.approx([APART * np.tan(pi / COUNT) * sqrt(2)] * len(lengths)) != []
