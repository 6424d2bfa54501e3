"""Plugins of a world, such as those that exert forces: what is read of one, and the registry of them."""

from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import (
    CannotWorkError,
    PluginReader,
    plugin_kind,
    plugin_node_name,
    read_plugin,
)
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.xml_reader import XmlReader
from drake_twin.extensions import Registry
from drake_twin.findings import Cause, Finding, Kind


@dataclass(frozen=True)
class WorldPlugin:
    """A plugin of a world.

    Attributes:
        type: What exerts its forces, as `drake_twin.controllers.world_forces.WORLD_FORCES` names it, or
            one of the kinds of `drake_twin.description.gazebo_drive` that exert none.
        parameters: The parameters of that.
        exerts_forces: Whether it exerts some.
        model: The model that never moves and has it; empty if the world has it.
    """

    type: str
    parameters: Any
    exerts_forces: bool = True
    model: str = ""


ConvertWorldPlugin: TypeAlias = Callable[[PluginReader], WorldPlugin]

WIND_EFFECTS = "gz_sim/WindEffects"
_OF_STATIC = ("triggered-publisher-system", "performer-detector-system", "touchplugin-system")

# By the kind of plugin, as `plugin_kind` names it.
WORLD_PLUGINS: Registry[ConvertWorldPlugin] = Registry(
    "Gazebo plugin of a world", "world_plugin", "drake_twin.world_plugins", ["drake_twin.description.plugins"]
)


def world_plugin(*names: str) -> Callable[[ConvertWorldPlugin], ConvertWorldPlugin]:
    """Register a function that converts a Gazebo plugin of a world.

    Args:
        names: The names of its library, as `drake_twin.description.gazebo_drive.gazebo_plugin` takes them.

    Raises:
        InputError: If another function converts a plugin of the name.
    """

    def register(function: ConvertWorldPlugin) -> ConvertWorldPlugin:
        for name in names:
            WORLD_PLUGINS.add(plugin_kind(GazeboPlugin(name, "")), function, function)
        return function

    return register


def is_world_plugin(plugin: GazeboPlugin) -> bool:
    """Tell whether a plugin of a world is of a kind that does something here."""
    return plugin_kind(plugin) in WORLD_PLUGINS


def read_world_plugins(reader: XmlReader, world: etree._Element) -> Iterator[WorldPlugin | Finding]:
    """Convert the plugins of a world, and report those that cannot work, and elements that are ignored.

    Raises:
        InputError: If a value is invalid; with file and line.
    """
    for element in world.findall("plugin"):
        plugin = read_plugin(reader, element)
        if is_world_plugin(plugin):
            yield from _converted(plugin)


def take_triggers(reader: XmlReader, model: etree._Element) -> Iterator[WorldPlugin | Finding]:
    """Convert those plugins of a static model that only publish messages, and remove them from it.

    Args:
        reader: The document.
        model: The model, with its name in the world.

    Raises:
        InputError: If a value is invalid; with file and line.
    """
    for element in model.findall("plugin"):
        plugin = read_plugin(reader, element)
        if plugin_kind(plugin) in _OF_STATIC:
            model.remove(element)
            yield from _converted(plugin, model.get("name", ""))


def _converted(plugin: GazeboPlugin, model: str = "") -> Iterator[WorldPlugin | Finding]:
    values = PluginReader(plugin, model)
    try:
        yield WORLD_PLUGINS[plugin_kind(plugin)](values)
    except CannotWorkError as error:
        what = f"Gazebo plugin {plugin_node_name(plugin)} ({plugin.filename}): {error}"
        yield Finding.at(Kind.NOT_STARTED, what, plugin.place)
        return
    common = f" of Gazebo plugin {plugin_node_name(plugin)}"
    for tag in values.unread:
        yield Finding.at(Kind.IGNORED, f"<{tag}>{common}", plugin.place, common=common, cause=Cause.UNREAD)
