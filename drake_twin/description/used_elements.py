"""The elements and attributes of URDF and SDF that the twin uses; everything else in a file is reported as ignored."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from lxml import etree

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


def _part(attributes: str = "", names: str | None = None, **children: Part) -> Part:
    return Part(frozenset(attributes.split()), children, None if names is None else frozenset(names.split()))


_TEXT = _part()
_TEXT_OR_VALUE = _part("value")
_ORIGIN = _part("xyz rpy")
_GEOMETRY = _part(
    box=_part("size"),
    cylinder=_part("radius length"),
    sphere=_part("radius"),
    capsule=_part("radius length"),
    ellipsoid=_part("a b c"),
    mesh=_part("filename scale"),
)
_GPIO_INTERFACE = _part("name data_type", param=_part("name", "initial_value"))
_MATERIAL = _part("name", color=_part("rgba"))
_SURFACE = _part(friction=_part(ode=_part(mu=_TEXT, mu2=_TEXT)))  # of which the smaller one counts
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
        hardware=_part(plugin=_TEXT, param=_part("name", "hold_joints position_proportional_gain mock_gpio_commands")),
        joint=_part(
            "name mimic",
            command_interface=_part("name", param=_part("name", "min max")),
            state_interface=_part("name", param=_part("name", "initial_value")),
            param=_part("name", "mimic multiplier offset"),
        ),
        sensor=_part(
            "name",
            state_interface=_part("name data_type", param=_part("name", "initial_value")),
            param=_part("name"),
        ),
        gpio=_part("name", command_interface=_GPIO_INTERFACE, state_interface=_GPIO_INTERFACE),
    ),
    # The last two ask that fixed joints are not lumped together, which the twin never does.
    gazebo=_part(
        "reference",
        mu1=_TEXT_OR_VALUE,
        mu2=_TEXT_OR_VALUE,
        selfCollide=_TEXT_OR_VALUE,
        self_collide=_TEXT_OR_VALUE,
        material=_TEXT,
        static=_TEXT_OR_VALUE,
        gravity=_TEXT_OR_VALUE,
        turnGravityOff=_TEXT_OR_VALUE,
        preserveFixedJoint=_TEXT_OR_VALUE,
        disableFixedJointLumping=_TEXT_OR_VALUE,
        collision=_part(surface=_SURFACE),
        visual=_part(material=_part(diffuse=_TEXT, ambient=_TEXT)),
    ),
)

_POSE = _part("relative_to rotation_format degrees frame")
_SDF_GEOMETRY = _part(
    box=_part(size=_TEXT),
    cylinder=_part(radius=_TEXT, length=_TEXT),
    sphere=_part(radius=_TEXT),
    capsule=_part(radius=_TEXT, length=_TEXT),
    cone=_part(radius=_TEXT, length=_TEXT),
    ellipsoid=_part(radii=_TEXT),
    mesh=_part(uri=_TEXT, scale=_TEXT),
    plane=_part(normal=_TEXT, size=_TEXT),
    empty=_TEXT,
)
_AXIS = _part(
    xyz=_part("expressed_in"),
    limit=_part(lower=_TEXT, upper=_TEXT, effort=_TEXT, velocity=_TEXT),
    dynamics=_part(damping=_TEXT, friction=_TEXT, spring_reference=_TEXT, spring_stiffness=_TEXT),
    use_parent_model_frame=_TEXT,
)
SDF_MODEL = _part(
    "name canonical_link placement_frame",
    pose=_POSE,
    static=_TEXT,
    self_collide=_TEXT,
    frame=_part("name attached_to", pose=_POSE),
    link=_part(
        "name",
        pose=_POSE,
        inertial=_part(
            pose=_POSE,
            mass=_TEXT,
            inertia=_part(ixx=_TEXT, ixy=_TEXT, ixz=_TEXT, iyy=_TEXT, iyz=_TEXT, izz=_TEXT),
        ),
        gravity=_TEXT,
        self_collide=_TEXT,
        visual=_part(
            "name",
            pose=_POSE,
            geometry=_SDF_GEOMETRY,
            material=_part(diffuse=_TEXT, ambient=_TEXT),
        ),
        collision=_part("name", pose=_POSE, geometry=_SDF_GEOMETRY, surface=_SURFACE),
    ),
    joint=_part(
        "name type",
        pose=_POSE,
        parent=_TEXT,
        child=_TEXT,
        axis=_AXIS,
        axis2=_AXIS,
        thread_pitch=_TEXT,
        screw_thread_pitch=_TEXT,
    ),
)

SDF_LIGHT = _part(
    "name type",
    pose=_POSE,
    direction=_TEXT,
    diffuse=_TEXT,
    specular=_TEXT,
    intensity=_TEXT,
    attenuation=_part(range=_TEXT, constant=_TEXT, linear=_TEXT, quadratic=_TEXT),
    spot=_part(inner_angle=_TEXT, outer_angle=_TEXT, falloff=_TEXT),
    cast_shadows=_TEXT,
    light_on=_TEXT,
    visualize=_TEXT,
)
SDF_PHYSICS = _part(
    "name type default",
    max_step_size=_TEXT,
    real_time_factor=_TEXT,
    real_time_update_rate=_TEXT,
    max_contacts=_TEXT,
    gravity=_TEXT,
)
SDF_SPHERICAL = _part(
    surface_model=_TEXT,
    latitude_deg=_TEXT,
    longitude_deg=_TEXT,
    elevation=_TEXT,
    heading_deg=_TEXT,
    world_frame_orientation=_TEXT,
)
# Elements of SDF that need no finding in a world: how things look, contact (`unused_contact` reports it), and what
# `sdf_model` reports itself, with models, plugins, sensors and lights inside.
NO_EFFECT_IN_WORLDS = frozenset(
    (
        *(
            "specular",
            "emissive",
            "script",
            "shader",
            "lighting",
            "render_order",
            "double_sided",
            "pbr",
            "transparency",
        ),
        *("contact", "bounce", "soft_contact", "torsional", "bullet", "submesh", "density", "fluid_added_mass", "auto"),
        *("stiffness", "dissipation", "heightmap", "image", "polyline", "convex_decomposition"),
        *("ode", "dart", "simbody", "magnetic_field"),  # of <physics>
        *("model", "plugin", "sensor", "light", "gripper", "particle_emitter", "projector"),
    )
)

REPORTED = _part()  # in a finding of its own
# The last two say where gz_ros2_control finds the robot, which is in the same file here.
ROS2_CONTROL = _part(
    "filename name",
    parameters=_TEXT,
    ros=_part(namespace=_TEXT, remapping=_TEXT),
    hold_joints=_TEXT,
    position_proportional_gain=_TEXT,
    robot_param=_TEXT,
    robot_param_node=_TEXT,
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
    above = URDF if parent.tag == "robot" else URDF.children.get(str(parent.tag), _TEXT)
    return child.tag in above.children or str(child.tag).startswith(DRAKE)
