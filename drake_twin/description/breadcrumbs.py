"""Models that a robot drops where it is, as gz-sim's Breadcrumbs does, as plain data."""

from collections.abc import Iterator

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import CannotWorkError, PluginReader
from drake_twin.description.performers import PERFORMER, check_volume
from drake_twin.description.plugin_element import PluginElement
from drake_twin.description.robot_description import Pose
from drake_twin.description.welded_models import weld_to_world
from drake_twin.values import parse_number


@dataclass(frozen=True)
class Deploy:
    """Drops a model.

    Attributes:
        name: The model's name; a number is put behind it.
        text: Its SDF, without a pose.
        pose: Its pose in the frame of the model that drops it.
        topic: The topic that asks for it: gz's, or after planning that of ROS.
        most: How often it can be dropped; None for ever.
        may_be_renamed: Whether it gets another name where its own is taken.
        fixed_after: How long it moves before it is fixed to the world (s); None for ever.
        number: Its number among those that its robot can drop.
        owner: The robot, after planning.
    """

    name: str
    text: str
    pose: Pose
    topic: str
    most: int | None = None
    may_be_renamed: bool = False
    fixed_after: float | None = None
    number: str = ""
    owner: str = ""


def read_breadcrumbs(plugin: PluginReader, number: str) -> Deploy | None:
    """Read ``gz-sim-breadcrumbs-system``.

    Args:
        plugin: The plugin.
        number: What the robot's other ones are told from it by.

    Returns:
        What it drops; None if it is disabled.

    Raises:
        CannotWorkError: If it has no model to drop.
        InputError: If a value is invalid; with file and line.
    """
    for tag in plugin.plugin.elements:
        if tag.startswith(("breadcrumb/", "performer_volume/geometry/box/")):
            plugin.has(tag)
    plugin.has("topic_statistics")  # which only counts messages
    most = plugin.number("max_deployments", -1)
    time = plugin.number("disable_physics_time", 0.0)
    may_be_renamed, topic = plugin.flag("allow_renaming", False), plugin.text("topic", "")
    if most != int(most):
        raise plugin.error(f"<max_deployments> is {most:g}, which is not a whole number")
    if most == 0:
        return None
    sdf = _inside(PluginElement("plugin", {}, "", plugin.plugin.tree), "breadcrumb", "sdf")
    model = _inside(sdf, "model")
    name = model.attributes.get("name", "")
    if not name:
        raise CannotWorkError("the <model> of its <breadcrumb> has no name")
    whole = etree.Element("sdf", version=sdf.attributes.get("version", "1.6"))
    whole.append(_as_xml(model))
    pose = whole.find("model/pose")
    text = "" if pose is None else (pose.text or "").strip()
    if pose is not None:
        whole[0].remove(pose)
    volume = next((item for item in plugin.plugin.tree if item.tag == "performer_volume"), None)
    if volume is not None:
        check_volume(plugin, volume)
        own = etree.SubElement(whole[0], "plugin", name="performer", filename=PERFORMER)
        own.extend(list(_all_as_xml(volume)))
    return Deploy(
        name=name,
        text=etree.tostring(whole, encoding="unicode"),
        pose=_pose(plugin, text),
        topic=f"/{topic.strip('/')}" if topic else f"/model/{{model}}/breadcrumbs/{name}/deploy",
        most=int(most) if most > 0 else None,
        may_be_renamed=may_be_renamed,
        fixed_after=time if time > 0.0 else None,
        number=number,
    )


def fixed_to_the_world(text: str) -> str:
    """Return a model's SDF with its links fixed to the world.

    Raises:
        ValueError: If it has no link of its own.
    """
    root = etree.fromstring(text.encode())
    model = root.find("model")
    assert model is not None, "it is the text of a Deploy"
    weld_to_world(model)
    return etree.tostring(root, encoding="unicode")


def _inside(element: PluginElement, *tags: str) -> PluginElement:
    for tag in tags:
        found = next((item for item in element.inside if item.tag == tag), None)
        if found is None:
            raise CannotWorkError(f"<{tag}> is missing" + (" in <breadcrumb>" if tag != "breadcrumb" else ""))
        element = found
    return element


def _as_xml(element: PluginElement) -> etree._Element:
    found = etree.Element(element.tag, dict(element.attributes))
    found.text = element.text
    found.extend(list(_all_as_xml(element)))
    return found


def _all_as_xml(element: PluginElement) -> Iterator[etree._Element]:
    yield from map(_as_xml, element.inside)


def _pose(plugin: PluginReader, text: str) -> Pose:
    try:
        values = [parse_number(word) for word in text.split()] or [0.0] * 6
        x, y, z, roll, pitch, yaw = values
    except ValueError:
        raise plugin.error(f"<pose> of the <breadcrumb> is {text!r}, which is not six finite numbers") from None
    return Pose((x, y, z), (roll, pitch, yaw))
