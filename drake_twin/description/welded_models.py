"""Models of an SDF that are fixed to the world by joints, and not by ``<static>``: as robots that stand still."""

from lxml import etree


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
