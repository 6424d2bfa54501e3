"""Models of an SDF that are fixed to the world by joints, and not by ``<static>``: as robots that stand still."""

from lxml import etree

from drake_twin.description.gazebo_plugins import plugin_kind
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.sdf_document import is_static

_HOLDS = "detachable-joint-system"


def weld_to_world(model: etree._Element) -> None:
    """Fix those links of a model to the world that no joint holds.

    Args:
        model: The ``<model>``; it is changed.

    Raises:
        ValueError: If it has no link of its own.
    """
    children = {joint.findtext("child", "").strip() for joint in model.findall("joint")}
    links = [name for link in model.findall("link") if (name := link.get("name", "")) not in children]
    if not links:
        raise ValueError("the model has no link of its own")
    for link in links:
        joint = etree.SubElement(model, "joint", name=f"{link}_fixed_to_the_world", type="fixed")
        etree.SubElement(joint, "parent").text = "world"
        etree.SubElement(joint, "child").text = link


def weld_holder(model: etree._Element) -> None:
    """Let a static model that holds others by detachable joints be a robot that is fixed to the world.

    Args:
        model: The ``<model>``; it is changed if it is such a one. Drake fixes nothing to an infinite plane.
    """
    plugins = [GazeboPlugin(item.get("filename", ""), item.get("name", "")) for item in model.findall("plugin")]
    holds = any(plugin_kind(plugin) == _HOLDS for plugin in plugins)
    if not holds or not is_static(model) or model.find("link") is None or model.find(".//plane") is not None:
        return
    for static in model.findall("static"):
        model.remove(static)
    weld_to_world(model)
