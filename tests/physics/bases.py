"""Bases on wheels, as URDF: what turns in place, rolls, and skids."""

RADIUS, TRACK, BASE, MASS = 0.1, 0.4, 0.5, 10.0


def base(wheels: dict[str, tuple[float, float]], *, roll: str = "1.5708", width: float = 0.04, caster: str = "") -> str:
    """URDF of a base.

    Args:
        wheels: name → where its centre is on the base, x and y (m).
        roll: how the wheels' links are rolled, as the file has it.
        width: of the wheels (m).
        caster: further elements.
    """
    parts = [
        f"""<robot name="base"><link name="chassis"><inertial><mass value="{MASS}"/>
<inertia ixx="0.15" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.5 0.3 0.05"/></geometry></collision></link>"""
    ]
    interfaces = ""
    for name, (x, y) in wheels.items():
        side = 0.5 / 12 * (3 * RADIUS**2 + width**2)
        parts.append(f"""<link name="{name}"><inertial><mass value="0.5"/>
<inertia ixx="{side}" iyy="{side}" izz="{0.5 * RADIUS**2 / 2}" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><cylinder radius="{RADIUS}" length="{width}"/></geometry></collision></link>
<joint name="{name}_joint" type="continuous"><parent link="chassis"/><child link="{name}"/>
<origin xyz="{x} {y} 0" rpy="{roll} 0 0"/><axis xyz="0 0 {-1 if roll.startswith("-") else 1}"/>
<limit effort="20" velocity="50"/></joint>""")
        interfaces += f'<joint name="{name}_joint"><command_interface name="velocity"/>'
        interfaces += '<state_interface name="position"/></joint>'
    return "".join(parts) + (
        f'{caster}<ros2_control name="c" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin>'
        f"</hardware>{interfaces}</ros2_control></robot>"
    )


def caster(x: float, name: str = "caster") -> str:
    """A frictionless ball below the chassis that reaches the ground."""
    radius = 0.03
    return f"""<link name="{name}"><inertial><mass value="0.1"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><sphere radius="{radius}"/></geometry></collision></link>
<joint name="{name}_joint" type="fixed"><parent link="chassis"/><child link="{name}"/>
<origin xyz="{x} 0 {radius - RADIUS}"/></joint>
<gazebo reference="{name}"><mu1>0</mu1><mu2>0</mu2></gazebo>"""


def two_wheels(**options) -> str:
    """Driven wheels left and right of the middle, and casters before and behind."""
    wheels = {"left": (0.0, TRACK / 2), "right": (0.0, -TRACK / 2)}
    return base(wheels, caster=caster(0.2, "front") + caster(-0.2, "rear"), **options)


def four_wheels(**options) -> str:
    """Four driven wheels that do not steer."""
    corners = {
        f"{end}_{side}": (x, y)
        for end, x in (("front", BASE / 2), ("rear", -BASE / 2))
        for side, y in (("left", TRACK / 2), ("right", -TRACK / 2))
    }
    return base(corners, **options)
