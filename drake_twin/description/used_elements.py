"""The elements and attributes of URDF and SDF that the twin uses; everything else in a file is reported as ignored."""

from collections.abc import Mapping
from dataclasses import field

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.findings import Weight

DRAKE = "{http://drake.mit.edu}"  # the namespace of what Drake's parser reads itself


@dataclass(frozen=True)
class Part:
    """What of an element is used.

    Attributes:
        attributes: Its attributes.
        children: The elements in it.
        names: Of ``<param>``, the names that are used; None where all are.
    """

    attributes: frozenset[str] = frozenset()
    children: Mapping[str, "Part"] = field(default_factory=dict)
    names: frozenset[str] | None = None


def _part(attributes: str = "", texts: str = "", values: str = "", names: str | None = None, **children: Part) -> Part:
    """Return a part: its attributes, its elements with a text, those with a ``value`` or a text, and the others."""
    every = dict.fromkeys(texts.split(), Part()) | dict.fromkeys(values.split(), Part(frozenset(["value"])))
    return Part(frozenset(attributes.split()), every | children, None if names is None else frozenset(names.split()))


_ORIGIN = _part("xyz rpy")
_GEOMETRY = _part(
    box=_part("size"),
    cylinder=_part("radius length"),
    sphere=_part("radius"),
    capsule=_part("radius length"),
    ellipsoid=_part("a b c"),
    mesh=_part("filename scale"),
)
_GPIO_INTERFACE = _part("name data_type", param=_part("name", names="initial_value"))
_MATERIAL = _part("name", color=_part("rgba"))
_SURFACE = _part(friction=_part(ode=_part(texts="mu mu2")))  # of which the smaller one counts
URDF = _part(
    "name version",
    material=_MATERIAL,
    link=_part(
        "name",
        inertial=_part(origin=_ORIGIN, mass=_part("value"), inertia=_part("ixx ixy ixz iyy iyz izz")),
        visual=_part("name", origin=_ORIGIN, geometry=_GEOMETRY, material=_MATERIAL),
        collision=_part("name", origin=_ORIGIN, geometry=_GEOMETRY),
    ),
    joint=_part(
        "name type dont_collapse",  # no joint is
        origin=_ORIGIN,
        parent=_part("link"),
        child=_part("link"),
        axis=_part("xyz"),
        limit=_part("lower upper effort velocity"),
        dynamics=_part("damping friction"),
        mimic=_part("joint multiplier offset"),
    ),
    ros2_control=_part(
        "name type",
        hardware=_part(
            texts="plugin", param=_part("name", names="hold_joints position_proportional_gain mock_gpio_commands")
        ),
        joint=_part(
            "name mimic",
            command_interface=_part("name", param=_part("name", names="min max")),
            state_interface=_part("name", param=_part("name", names="initial_value")),
            param=_part("name", names="mimic multiplier offset"),
        ),
        sensor=_part(
            "name",
            state_interface=_part("name data_type", param=_part("name", names="initial_value")),
            param=_part("name"),
        ),
        gpio=_part("name", command_interface=_GPIO_INTERFACE, state_interface=_GPIO_INTERFACE),
    ),
    # The last two ask that fixed joints are not lumped together, which the twin never does.
    gazebo=_part(
        "reference",
        "material",
        "mu1 mu2 selfCollide self_collide enable_wind static gravity turnGravityOff"
        " preserveFixedJoint disableFixedJointLumping",
        collision=_part(surface=_SURFACE),
        visual=_part(material=_part(texts="diffuse ambient")),
    ),
)

_POSE = _part("relative_to rotation_format degrees frame")
_SDF_GEOMETRY = _part(
    texts="empty",
    box=_part(texts="size"),
    cylinder=_part(texts="radius length"),
    sphere=_part(texts="radius"),
    capsule=_part(texts="radius length"),
    cone=_part(texts="radius length"),
    ellipsoid=_part(texts="radii"),
    mesh=_part(texts="uri scale"),
    plane=_part(texts="normal size"),
)
_AXIS = _part(
    texts="use_parent_model_frame",
    xyz=_part("expressed_in"),
    limit=_part(texts="lower upper effort velocity"),
    dynamics=_part(texts="damping friction spring_reference spring_stiffness"),
    mimic=_part("joint axis", "multiplier reference offset"),
)
SDF_MODEL = _part(
    "name canonical_link placement_frame",
    "static self_collide enable_wind",
    pose=_POSE,
    frame=_part("name attached_to", pose=_POSE),
    link=_part(
        "name",
        "gravity self_collide enable_wind",
        pose=_POSE,
        inertial=_part(
            "auto",
            "mass density",
            pose=_POSE,
            inertia=_part(texts="ixx ixy ixz iyy iyz izz"),
            fluid_added_mass=_part(texts=" ".join(a + b for i, a in enumerate("xyzpqr") for b in "xyzpqr"[i:])),
        ),
        visual=_part("name", pose=_POSE, geometry=_SDF_GEOMETRY, material=_part(texts="diffuse ambient emissive")),
        collision=_part("name", "density", pose=_POSE, geometry=_SDF_GEOMETRY, surface=_SURFACE),
    ),
    joint=_part("name type", "parent child thread_pitch screw_thread_pitch", pose=_POSE, axis=_AXIS, axis2=_AXIS),
)

SDF_LIGHT = _part(
    "name type",
    "direction diffuse specular intensity cast_shadows light_on visualize",
    pose=_POSE,
    attenuation=_part(texts="range constant linear quadratic"),
    spot=_part(texts="inner_angle outer_angle falloff"),
)
SDF_PHYSICS = _part("name type default", "max_step_size real_time_factor real_time_update_rate max_contacts gravity")
SDF_WIND = _part(texts="linear_velocity")
SDF_SPHERICAL = _part(texts="surface_model latitude_deg longitude_deg elevation heading_deg world_frame_orientation")
# Elements of SDF that need no finding in a world: how things look, contact (`unused_contact` reports it), and what
# `sdf_model` reports itself, with models, plugins, sensors and lights inside.
NO_EFFECT_IN_WORLDS = frozenset(
    (
        *(
            "specular",
            "script",
            "shader",
            "lighting",
            "render_order",
            "double_sided",
            "pbr",
            "transparency",
        ),
        *("contact", "bounce", "soft_contact", "torsional", "bullet", "submesh"),
        *("stiffness", "dissipation", "heightmap", "image", "polyline", "convex_decomposition"),
        *("ode", "dart", "simbody", "magnetic_field"),  # of <physics>
        *("model", "plugin", "sensor", "light", "gripper", "particle_emitter", "projector"),
    )
)

# The last two say where gz_ros2_control finds the robot, which is in the same file here.
ROS2_CONTROL = _part(
    "filename name",
    "parameters hold_joints position_proportional_gain robot_param robot_param_node",
    ros=_part(texts="namespace remapping"),
)

# Parent and child, where several children are used; of any other only the first one is.
SEVERAL = {
    *(("robot", tag) for tag in ("link", "joint", "material", "gazebo", "ros2_control")),
    *(("model", tag) for tag in ("link", "joint", "frame")),
    *(("link", tag) for tag in ("visual", "collision")),
    *(("ros2_control", tag) for tag in ("joint", "sensor", "gpio")),
    *(("joint", tag) for tag in ("command_interface", "state_interface", "param")),
    *(("sensor", tag) for tag in ("state_interface", "param")),
    *(("gpio", tag) for tag in ("command_interface", "state_interface")),
    *((tag, "param") for tag in ("hardware", "command_interface", "state_interface")),
    ("plugin", "parameters"),
    ("ros", "remapping"),
}


# What says how something looks, with all in it, and what only ROS 1 used.
_LOOKS = frozenset(("visual", "material", "scene", "light", "script", "color", "grid", "gui"))
_LOOKS |= {"transmission", "hardwareInterface", "safety_controller", "calibration"}


def weight_of(element: etree._Element) -> Weight:
    """Return what an element of a URDF, an SDF model or a world is for."""
    if element.tag == "include":
        return Weight.LOST
    is_seen = any(each.tag in _LOOKS for each in (element, *element.iterancestors()))
    return Weight.LOOKS if is_seen else Weight.MOVES


def is_known(parent: etree._Element, child: etree._Element) -> bool:
    """Tell whether the twin or Drake reads an element of ``<robot>``, ``<link>`` or ``<joint>``."""
    above = URDF if parent.tag == "robot" else URDF.children.get(str(parent.tag), Part())
    return child.tag in above.children or str(child.tag).startswith(DRAKE)
