"""The models of a world file that are robots: those that a plugin, or the fluid about them, drives."""

from copy import deepcopy

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import is_ros2_control, works_while_still
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.xml_reader import XmlReader


@dataclass(frozen=True)
class RobotText:
    """A robot's SDF, without a pose, that stands in another file.

    Attributes:
        file: That file's name, without its folder.
        text: The SDF; its lines have the numbers that they have in that file.
    """

    file: str
    text: str


def robot_text(
    model: etree._Element, version: tuple[int, ...], reader: XmlReader, *, is_still: bool
) -> RobotText | None:
    """Return a model's own SDF if one of its plugins, or the fluid about it, drives it.

    Of a static one those count that move something else, as a belt does.
    """
    plugins = model.findall("plugin")
    has_mass_of_fluid = next(model.iter("fluid_added_mass"), None) is not None
    if not plugins and not has_mass_of_fluid:
        return None
    from drake_twin.description.gazebo_drives import is_drive

    found = [GazeboPlugin(filename=item.get("filename", ""), name=item.get("name", "")) for item in plugins]
    drives = any(works_while_still(plugin) for plugin in found)
    if not is_still:
        drives = drives or has_mass_of_fluid or any(is_drive(plugin) or is_ros2_control(plugin) for plugin in found)
    if not drives:
        return None
    copy = deepcopy(model)
    for pose in copy.findall("pose"):
        copy.remove(pose)
    for address in copy.iter("uri"):
        name = (address.text or "").strip()
        if name and "://" not in name and reader.file is not None:  # relative to the file that it stands in
            address.text = str(reader.file.parent / name)
    line: object = model.sourceline  # the stubs' type is not a number's
    above = "\n" * (line - 1 if isinstance(line, int) else 0)
    text = f'{above}<sdf version="{".".join(map(str, version))}">{etree.tostring(copy, encoding="unicode")}</sdf>'
    return RobotText("world.sdf" if reader.file is None else reader.file.name, text)
