"""URDF texts for the tests of repairs."""

from pathlib import Path

from lxml import etree

from drake_twin.description.repairs import repair_urdf
from drake_twin.description.xml_reader import XmlReader

INERTIAL = '<inertial><mass value="{mass}"/>{inertia}</inertial>'
INERTIA = '<inertia ixx="{}" ixy="{}" ixz="{}" iyy="{}" iyz="{}" izz="{}"/>'
SOLID = INERTIAL.format(mass=1, inertia=INERTIA.format(1, 0, 0, 1, 0, 1))
BOX = '<geometry><box size="1 1 1"/></geometry>'


def mend(body: str, name: str = 'name="r"', **options) -> tuple[etree._Element, list[str]]:
    """The robot's tree after the repairs, and what they say; the body begins in line 2."""
    reader = XmlReader(f"<robot {name}>\n{body}\n</robot>", Path("arm.xacro"))
    repairs = repair_urdf(reader, **options)
    return reader.root, [str(repair) for repair in repairs]


def link(name: str = "base", inside: str = SOLID) -> str:
    return f'<link name="{name}">{inside}</link>'


def joint(name="elbow", kind="continuous", parent="base", child="arm", inside="") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


def arm(*joints: str) -> str:
    """A base, an arm and a hand in lines 2 to 4, and the joints after them, one a line."""
    return "\n".join([link(), link("arm"), link("hand"), *joints])


LIMIT = '<limit lower="-1" upper="1" effort="5" velocity="1"/>'
HEALTHY = arm(
    joint(kind="revolute", inside=LIMIT),
    joint("wrist", "prismatic", "arm", "hand", LIMIT + '<mimic joint="elbow"/>'),
    '<link name="tool"/>',
    joint("mount", "fixed", "hand", "tool"),
    '<ros2_control name="s" type="system"><joint name="elbow"><command_interface name="velocity"/></joint>'
    "</ros2_control>",
    link("camera", f"<visual>{BOX}</visual><collision>{BOX}</collision>"),
    joint("camera_mount", "fixed", "hand", "camera"),
)

# One broken robot for each rule.
BROKEN = {
    "robot_without_name": ("", link()),
    "robot_without_links": ('name="r"', ""),
    "joint_without_limits": ('name="r"', arm(joint(kind="revolute"))),
    "continuous_joint_with_limits": ('name="r"', arm(joint(inside=LIMIT), joint("wrist", "fixed", "arm", "hand"))),
    "floating_joint": ('name="r"', arm(joint(kind="floating"), joint("wrist", "fixed", "arm", "hand"))),
    "effort_limit": (
        'name="r"',
        arm(
            joint(kind="revolute", inside=LIMIT.replace("5", "0")),
            '<ros2_control name="s" type="system"><joint name="elbow"><command_interface name="velocity"/></joint>'
            "</ros2_control>",
        ),
    ),
    "velocity_limit": ('name="r"', arm(joint(kind="revolute", inside=LIMIT.replace('velocity="1"', 'velocity="0"')))),
    "mimic": ('name="r"', arm(joint(inside='<mimic joint="gone"/>'))),
    "shape_without_size": ('name="r"', link(inside=SOLID + f"<visual>{BOX.replace('1 1 1', '0 0 0')}</visual>")),
    "shape_without_geometry": ('name="r"', link(inside=SOLID + "<visual/>")),
    "color": (
        'name="r"',
        link(inside=SOLID + f'<visual>{BOX}<material name="m"><color rgba="9 0 0 1"/></material></visual>'),
    ),
    "inertia": ('name="r"', link(inside=SOLID.replace('ixx="1"', 'ixx="9"'))),
    "massless_link": ('name="r"', '<link name="base"/>'),
    "sensor_frame": (
        'name="r"',
        link()
        + '<gazebo reference="base"><sensor name="s"><pose relative_to="gone">0 0 1 0 0 0</pose></sensor></gazebo>',
    ),
}
