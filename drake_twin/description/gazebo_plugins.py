"""The ``<plugin>`` tags of a robot file as plain data: their elements, and the topics that they name."""

import re
import shlex
from collections.abc import Iterable, Iterator

from lxml import etree

from drake_twin.description.plugin_element import PluginElement
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.values import is_true, parse_number

GZ_LIBRARY = re.compile(r"(?:lib)?(?:gz-sim|ignition-gazebo)\d*-([\w-]+?)(?:\.so)?")
_CLASSIC_LIBRARY = re.compile(r"(?:lib)?(gazebo_ros_\w+?)(?:\.so)?")
LEVELS = "gz::sim"  # the name of the plugin, whose library may have any
_OF_LEVELS = (LEVELS, "ignition::gazebo")
CLASS = re.compile(r"(?:gz::sim|ignition::gazebo)(?:::v\d+)?::systems::(\w+)")

# Kinds of plugins whose work the twin does without them.
DONE_HERE = frozenset(
    (
        *("physics-system", "user-commands-system", "scene-broadcaster-system", "sensors-system", "imu-system"),
        *("forcetorque-system", "force-torque-system", "contact-system", "navsat-system", "nav-sat-system"),
        *("magnetometer-system", "altimeter-system", "air-pressure-system", "air-speed-system"),
        "logical-camera-system",
        *("gazebo_ros_init", "gazebo_ros_factory", "gazebo_ros_clock", "gazebo_ros_state"),
    )
)


def read_plugins(reader: XmlReader, path: str) -> Iterator[GazeboPlugin]:
    """Read the plugins at a path of a document: ``gazebo/plugin`` in a URDF, ``model/plugin`` in an SDF."""
    for plugin in reader.root.iterfind(path):
        yield read_plugin(reader, plugin)


def is_ros2_control(plugin: GazeboPlugin) -> bool:
    """Tell whether a plugin is one of gz_ros2_control or gazebo_ros2_control, in any spelling."""
    return "ros2_control" in plugin.filename + plugin.name


def is_of_gazebo_sim(plugin: etree._Element) -> bool:
    """Tell whether a ``<plugin>`` is one of Gazebo Sim's own, and so not one of Gazebo classic."""
    return bool(GZ_LIBRARY.fullmatch(plugin.get("filename", "")) or CLASS.fullmatch(plugin.get("name", "")))


def read_plugin(reader: XmlReader, plugin: etree._Element) -> GazeboPlugin:
    """Read a ``<plugin>``."""
    elements: dict[str, tuple[str, ...]] = {}
    for name, text in _texts(plugin):
        elements[name] = (*elements.get(name, ()), text)
    namespace = plugin.findtext("ros/namespace")
    return GazeboPlugin(
        filename=plugin.get("filename", ""),
        name=plugin.get("name", ""),
        parameters=tuple(text for text in elements.get("parameters", ()) if text),
        namespace=None if namespace is None else namespace.strip(),
        elements=elements,
        place=reader.place(plugin),
        tree=tuple(_tree(plugin)),
    )


def _tree(element: etree._Element) -> Iterator[PluginElement]:
    for child in element:
        if isinstance(child.tag, str):
            attributes = {str(name): str(value) for name, value in child.attrib.items()}
            yield PluginElement(child.tag, attributes, (child.text or "").strip(), tuple(_tree(child)))


def _texts(element: etree._Element, above: str = "") -> Iterator[tuple[str, str]]:
    for child in element:
        if not isinstance(child.tag, str):
            continue
        name = f"{above}{child.tag}"
        if len(child):
            yield from _texts(child, f"{name}/")
        else:
            yield name, (child.text or "").strip()


def plugin_kind(plugin: GazeboPlugin) -> str:
    """Return a plugin's kind, in any spelling of its library: ``gazebo_ros_diff_drive``, ``diff-drive-system``."""
    library = plugin.filename.rpartition("/")[2]
    for pattern in (GZ_LIBRARY, _CLASSIC_LIBRARY):
        match = pattern.fullmatch(library)
        if match:
            return match[1]
    if plugin.name in _OF_LEVELS:
        return LEVELS
    match = CLASS.fullmatch(plugin.name)
    return class_kind(match[1]) if match else library


def is_belt(plugin: GazeboPlugin) -> bool:
    """Tell whether a plugin moves the surface of a link, also of one that stands still."""
    return plugin_kind(plugin) == "track-controller-system"


def works_while_still(plugin: GazeboPlugin) -> bool:
    """Tell whether a plugin moves or holds something else than its model, which may be static."""
    return is_belt(plugin) or plugin_kind(plugin) == "detachable-joint-system"


def track_links(plugins: Iterable[GazeboPlugin]) -> frozenset[str]:
    """Return the links whose surfaces are moved by plugins."""
    return frozenset(link for plugin in plugins if is_belt(plugin) for link in plugin.elements.get("link", ())[:1])


def class_kind(name: str) -> str:
    """Return the kind of a class of gz-sim: ``diff-drive-system`` for ``DiffDrive``."""
    return f"{_words(name, '-')}-system"


def plugin_node_name(plugin: GazeboPlugin) -> str:
    """Return the name of a plugin's node: its name, or ``diff_drive`` for ``gz::sim::systems::DiffDrive``."""
    name = plugin.name.rpartition("::")[2]
    if name != plugin.name:
        name = _words(name, "_")
    return re.sub(r"\W+", "_", name).strip("_") or re.sub(r"\W+", "_", plugin_kind(plugin))


def _words(name: str, separator: str) -> str:
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", separator, name).lower()


def ros_topic(plugin: GazeboPlugin, topic: str) -> str:
    """Resolve a topic of a classic plugin in the robot's namespace, with the remappings of its ``<ros>`` tag.

    Args:
        plugin: The plugin.
        topic: The topic's name in the plugin, ``cmd_vel``.

    Returns:
        A name relative to the robot's namespace, or one with a leading ``/`` where a remapping puts it elsewhere.
    """
    namespace = (plugin.namespace or "").strip("/")
    before_all = f"/{namespace}/" if namespace else "/"

    def relative(name: str) -> str:
        """Remove the plugin's own namespace; a name elsewhere keeps its leading slash."""
        if name.startswith("~"):
            return f"{plugin_node_name(plugin)}/{name.lstrip('~/')}"
        return name[len(before_all) :] if namespace and name.startswith(before_all) else name

    def is_same(one: str, other: str) -> bool:
        absolute = (name if name.startswith("/") else before_all + name for name in (one, other))
        return len(set(absolute)) == 1

    for before, after in plugin_remappings(plugin):
        if is_same(relative(before), topic):
            return relative(after)
    return topic


def plugin_remappings(plugin: GazeboPlugin) -> Iterator[tuple[str, str]]:
    """Yield the rules of a plugin's ``<ros>`` tag that rename topics, as written."""
    texts: Iterable[str] = [
        *plugin.elements.get("ros/remapping", ()),
        *(word for text in plugin.elements.get("ros/argument", ()) for word in _words_of(text)),
    ]
    for text in texts:
        before, assigned, after = text.partition(":=")
        if assigned and not before.startswith("__"):
            yield before.strip(), after.strip()


def _words_of(text: str) -> list[str]:
    """Split an argument as a shell does; one with a quote that does not end is one word."""
    try:
        return shlex.split(text)
    except ValueError:
        return [text]


_OF_ALL_PLUGINS = {"ros", "ros/namespace", "ros/remapping", "ros/argument"}


class CannotWorkError(Exception):
    """Raised for a plugin that Gazebo would load, but that would do nothing; the message says why."""


class PluginReader:
    """Reads the values of a plugin's elements; errors name the file, the line and the element.

    Args:
        plugin: The plugin.
        model: The model of a world that never moves and has it; empty for others.
    """

    def __init__(self, plugin: GazeboPlugin, model: str = ""):
        self.plugin, self.model = plugin, model
        self._taken: set[str] = set()

    @property
    def unread(self) -> tuple[str, ...]:
        """The elements that were not read."""
        return tuple(tag for tag in self.plugin.elements if tag not in self._taken | _OF_ALL_PLUGINS)

    def error(self, message: str) -> InputError:
        """Return an error that points at the plugin."""
        return InputError(
            f"<plugin filename={self.plugin.filename!r}>: {message}",
            file=self.plugin.place.file or None,
            line=self.plugin.place.line,
        )

    def has(self, tag: str) -> bool:
        """Tell whether the plugin has an element of a name."""
        self._taken.add(tag)
        return tag in self.plugin.elements

    def skip(self, tag: str, *defaults: str) -> None:
        """Note an element as read where it holds what the twin does without it."""
        if set(self.plugin.elements.get(tag, ())) <= set(defaults):
            self._taken.add(tag)

    def texts(self, tag: str) -> tuple[str, ...]:
        """Read all elements of a name that are not empty."""
        self._taken.add(tag)
        return tuple(text for text in self.plugin.elements.get(tag, ()) if text)

    def text(self, tag: str, default: str) -> str:
        """Read the first element of a name."""
        return next(iter(self.texts(tag)), default)

    def numbers(self, tag: str) -> tuple[float, ...]:
        """Read all elements of a name as finite numbers; where they are all empty, none is read."""
        if not any(self.plugin.elements.get(tag, ())):
            return ()
        values = []
        for text in self.texts(tag):
            try:
                values.append(parse_number(text))
            except ValueError as error:
                raise self.error(f"<{tag}> is {text!r}, which is {error}") from None
        return tuple(values)

    def number(self, tag: str, default: float) -> float:
        """Read the first element of a name as a finite number."""
        return next(iter(self.numbers(tag)), default)

    def vector(self, tag: str) -> tuple[float, float, float]:
        """Read the first element of a name as three finite numbers; zeros without it."""
        text = self.text(tag, "0 0 0")
        try:
            x, y, z = map(parse_number, text.split())
        except ValueError:
            raise self.error(f"<{tag}> is {text!r}, which is not three finite numbers") from None
        return x, y, z

    def flag(self, tag: str, default: bool) -> bool:
        """Read the first element of a name as a flag: ``true``, ``1``, ``false`` or ``0``."""
        text = self.text(tag, str(default)).lower()
        if text not in ("true", "false", "1", "0"):
            raise self.error(f"<{tag}> is {text!r}, which is neither true nor false")
        return is_true(text)
