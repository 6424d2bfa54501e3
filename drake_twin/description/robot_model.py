"""A robot file of any kind (xacro, URDF, SDF, MJCF) as its description and the text that Drake is given."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import DRAKE_RULES, drake_link_name, prepare_urdf
from drake_twin.description.flags import wrong_flags
from drake_twin.description.gazebo_plugins import read_plugins
from drake_twin.description.hardware_names import unknown_hardware_names
from drake_twin.description.link_gravity import gravity_of_sdf, gravity_of_urdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.repairs import check_repair_names, repair_urdf
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.roller_wheels import roller_links
from drake_twin.description.source_file import read_xml, without_default_namespace
from drake_twin.description.unread import unread_in_sdf, unread_in_urdf
from drake_twin.description.unused_contact import unused_in_sdf, unused_in_urdf
from drake_twin.description.urdf import describe_urdf, is_static_in_gazebo, skip_wrong_bounds
from drake_twin.description.urdf_values import check_values
from drake_twin.description.xacro_file import expand_xacro, places_of_expanded
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind, Place, at_places
from drake_twin.progress import tell

_EXPANDED = "<!-- drake_twin: expanded -->"
_LINK = re.compile(r"<(?:link|body)[\s/>]")

MOST_LINKS = 1_000  # of one robot; a chain of so many takes 4 s and 0.4 GB


@dataclass(frozen=True)
class RobotModel:
    """A robot's description, and the same robot as Drake's parser accepts it.

    Attributes:
        description: The robot as its file describes it.
        drake_text: The model for Drake's parser; its model instance has the robot's name in the twin.
        drake_format: ``urdf``, ``sdf``, or ``xml`` for MJCF.
        is_fixed: Whether the root link is welded to the world where the robot is spawned.
        findings: What was mended in the file, what of it is ignored, and xacro's warnings.
        meshes: The mesh files that the robot refers to.
        falls: Whether gravity acts on it.
    """

    description: RobotDescription
    drake_text: str
    drake_format: str
    is_fixed: bool
    findings: tuple[Finding, ...] = ()
    meshes: tuple[Path, ...] = ()
    falls: bool = True

    @property
    def root_body(self) -> str:
        """The name of the root link's body in the Drake model."""
        return drake_link_name(self.description.root_link)


def load_robot_model(
    address: str,
    packages: PackageIndex,
    *,
    name: str | None = None,
    xacro_args: Mapping[str, str] | None = None,
    without_repairs: Collection[str] = (),
    collision: str = "hull",
) -> RobotModel:
    """Load a robot.

    Args:
        address: Its file: a path, or ``package://``, ``model://``, ``file://``.
        packages: Resolves it and what it refers to.
        name: Its name in the twin; by default the name that the file gives.
        xacro_args: Values for the ``<xacro:arg>``s of a xacro file.
        without_repairs: Names of repairs to leave out.
        collision: What a collision mesh becomes: ``hull`` or ``decomposition``.

    Raises:
        InputError: If a file is missing or wrong; see the functions of this package that read it.
    """
    check_repair_names(without_repairs, DRAKE_RULES)
    file = packages.resolve(address)
    text = read_robot_file(file)
    arguments = dict(xacro_args or {})
    kind = _outermost_tag(text)
    tell(f"reading {file.name}")
    _check_size(text, file)
    if kind != "robot":
        _refuse_arguments(arguments, file)
        model = _load_mjcf(text, file, name) if kind == "mujoco" else _load_sdf(text, file, name, packages)
        unused = [f"collision: {collision}"] if collision != "hull" else []
        unused += [f"without_repairs: {', '.join(without_repairs)}"] if without_repairs else []
        meaningless = (f"{what} has no effect on a file that is not URDF" for what in unused)
        return replace(model, findings=(*model.findings, *(Finding(Kind.WARNING, what) for what in meaningless)))
    places: Sequence[Place] | None = None
    warnings: Sequence[str] = ()
    if is_xacro_text(text):
        text, places, warnings = expand_xacro(file, arguments, packages)
        _check_size(text, file)
    else:
        _refuse_arguments(arguments, file)
        places = places_of_expanded(text)
    text = without_default_namespace(text)  # which other readers of it look at
    reader = XmlReader(text, file, places=places)
    check_values(reader)
    skipped = tuple(skip_wrong_bounds(reader))
    unread = (*unread_in_urdf(reader), *unknown_hardware_names(reader), *wrong_flags(reader, reader.root))
    repairs = repair_urdf(reader, without_repairs)
    description = describe_urdf(reader, text)
    unused_surfaces = unused_in_urdf(reader, roller_links(description))
    gravity = gravity_of_urdf(reader)
    prepared = prepare_urdf(
        reader, description, name or description.name, packages, without=without_repairs, collision=collision
    )
    return RobotModel(
        description=description,
        drake_text=prepared.text,
        drake_format="urdf",
        is_fixed=description.root_link == "world" or is_static_in_gazebo(reader.root),
        findings=(
            *(*repairs, *skipped, *prepared.findings),
            *(Finding(Kind.WARNING, what) for what in warnings),
            *(*unused_surfaces, *gravity.findings, *unread),
        ),
        meshes=prepared.meshes,
        falls=gravity.falls,
    )


def _check_size(text: str, file: Path) -> None:
    """Refuse a robot of more links than can be simulated: memory and time grow with their square."""
    count = len(_LINK.findall(text))
    if count > MOST_LINKS:
        raise InputError(f"the robot has {count:,} links, and {MOST_LINKS:,} are the most", file=file)


def robot_name_in_file(file: Path, packages: PackageIndex, xacro_args: Mapping[str, str]) -> str:
    """Read the name that a robot file gives its robot, and nothing else of the robot.

    Raises:
        InputError: If the file cannot be read, or is not well-formed.
    """
    text = read_robot_file(file)
    if _outermost_tag(text) == "robot" and is_xacro_text(text):
        text = expand_xacro(file, xacro_args, packages).text
    root = XmlReader(text, file).root
    model = root.find("model")
    name = root.get("model") or root.get("name") or (model.get("name") if model is not None else None)
    return name or file.name.split(".")[0]


def _load_sdf(text: str, file: Path, name: str | None, packages: PackageIndex) -> RobotModel:
    from drake_twin.description.added_mass import added_mass_plugins
    from drake_twin.description.drake_model import describe_model
    from drake_twin.description.included_model import included_model
    from drake_twin.description.link_surface import sdf_surfaces
    from drake_twin.description.link_wind import windy_links_of_sdf
    from drake_twin.description.sdf import joint_frictions, prepare_sdf, read_robot_sdf
    from drake_twin.description.sdf_document import check_version
    from drake_twin.description.sdf_mimic import followers
    from drake_twin.description.sdf_values import with_place, wrong_numbers
    from drake_twin.description.sensors import sensors_in_sdf

    text, file, lost = included_model(without_default_namespace(text), file, packages)
    reader, moved = read_robot_sdf(text, file)
    prepared, is_fixed, own_name, findings = prepare_sdf(reader, name, packages)
    if reader.root.get("version") is None:
        raise reader.error(reader.root, "the attribute 'version' is missing")
    check_version(reader)
    (model,) = reader.root.findall("model")
    frictions = {name: (friction, place) for name, friction, place in joint_frictions(reader, model)}
    try:
        description = describe_model(prepared, "sdf", text, file, own_name)
    except InputError as error:
        raise with_place(error, reader) from None
    plugins = (*read_plugins(reader, "model/plugin"), *added_mass_plugins(reader, model))
    mimics = {joint.get("name", ""): mimic for joint, mimic in followers(model)}
    joints = [
        replace(joint, friction=frictions.pop(joint.name)[0]) if joint.is_movable and joint.name in frictions else joint
        for joint in description.joints
    ]
    joints = [replace(joint, mimic=mimics[joint.name]) if joint.name in mimics else joint for joint in joints]
    unbraked = ((f"friction of joint {name}", place) for name, (_, place) in frictions.items())
    description = replace(
        description,
        joints=tuple(joints),
        sensors=tuple(sensors_in_sdf(reader)),
        plugins=plugins,
        surfaces=sdf_surfaces(model),
        windy_links=tuple(windy_links_of_sdf(model)),
    )
    unused = unused_in_sdf(reader, model, with_links=True, rollers=roller_links(description))
    gravity = gravity_of_sdf(reader, model)
    return RobotModel(
        description,
        prepared,
        "sdf",
        is_fixed,
        findings=(
            *(*lost, *moved, *unused, *at_places(Kind.IGNORED, unbraked), *findings, *gravity.findings),
            *(*unread_in_sdf(reader), *wrong_flags(reader, model), *wrong_numbers(reader, model)),
        ),
        falls=gravity.falls,
    )


def _load_mjcf(text: str, file: Path, name: str | None) -> RobotModel:
    from drake_twin.description.drake_model import describe_model
    from drake_twin.description.mjcf import prepare_mjcf

    prepared, is_fixed, own_name, actuators, findings = prepare_mjcf(text, file, name)
    described = describe_model(prepared, "xml", text, file, own_name, actuators.systems, actuators.efforts)
    read = actuators.joints
    joints = tuple(
        replace(
            joint,
            armature=read[joint.name].armature,
            friction=read[joint.name].friction,
            stiffness=read[joint.name].stiffness,
            rest_position=read[joint.name].rest,
        )
        if joint.name in read
        else joint
        for joint in described.joints
    )
    description = replace(described, joints=joints)
    return RobotModel(description, prepared, "xml", is_fixed, findings=findings)


def read_robot_file(file: Path) -> str:
    """Read a robot file's text.

    Raises:
        InputError: If the file cannot be read as text, or its kind is unknown.
    """
    if not file.is_file():
        raise InputError("this is not a file: a robot file is needed", file=file)
    text = read_xml(file, "robot file")
    if _outermost_tag(text) is None:
        kinds = "a xacro or URDF (<robot>), an SDF (<sdf>) or an MJCF (<mujoco>)"
        raise InputError(f"this is not a robot file, which is {kinds}", file=file)
    return text


def _outermost_tag(text: str) -> str | None:
    match = re.search(r"<(robot|sdf|mujoco)[\s/>]", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
    return None if match is None else match[1]


def as_expanded(text: str) -> str:
    """Mark a description that came in a message or a bag, so that xacro never expands it: its expressions are code."""
    return f"{text.rstrip()}\n{_EXPANDED}\n"


def is_xacro_text(text: str) -> bool:
    """Tell whether a robot file, of any suffix, needs xacro: it declares its namespace or uses its substitutions."""
    if text.rstrip().endswith(_EXPANDED):
        return False
    return "ros.org/wiki/xacro" in text or "wiki.ros.org/xacro" in text or any(mark in text for mark in ("$(", "${"))


def _refuse_arguments(arguments: Mapping[str, str], file: Path) -> None:
    if arguments:
        given = ", ".join(f"{name}:={value}" for name, value in arguments.items())
        raise InputError(f"{given} cannot be used: only xacro files take arguments", file=file)
