"""gz-sim's ApplyLinkWrench in a world file: forces on links by topics, and forces that act from the start."""

from collections.abc import Callable, Iterator

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import plugin_kind
from drake_twin.description.robot_description import GazeboPlugin, Vector3
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError

WRENCH_SYSTEM = "apply-link-wrench-system"
_TYPES = ("link", "model")


@dataclass(frozen=True)
class LinkWrench:
    """A force and a torque on a link, in the world's axes.

    Attributes:
        entity: The link, as ``model::link``, or a model for its root link.
        force: The force at the link's origin (N).
        torque: The torque (N·m).
    """

    entity: str
    force: Vector3
    torque: Vector3


@dataclass(frozen=True)
class WrenchSystem:
    """A plugin of a world that exerts forces on links.

    Attributes:
        topic: The topic of those for one step.
        topic_persistent: The topic of those that stay.
        topic_clear: The topic that ends them.
        persistent: Those that act from the start.
    """

    topic: str
    topic_persistent: str
    topic_clear: str
    persistent: tuple[LinkWrench, ...] = ()


def read_wrench_systems(
    reader: XmlReader, world: etree._Element, lost: Callable[[InputError], None]
) -> Iterator[WrenchSystem]:
    """Convert each ``gz-sim-apply-link-wrench-system`` to forces on links, by topics and from the start.

    Args:
        reader: The world's document.
        world: Its ``<world>``.
        lost: Is told what is wrong with a ``<persistent>`` that cannot be used: it is left out.
    """
    common = f"/world/{world.get('name', '')}/wrench"
    for plugin in world.findall("plugin"):
        if plugin_kind(GazeboPlugin(plugin.get("filename", ""), plugin.get("name", ""))) != WRENCH_SYSTEM:
            continue
        names = {"topic": common, "topic_persistent": f"{common}/persistent", "topic_clear": f"{common}/clear"}
        topics = {tag: f"/{(plugin.findtext(tag) or '').strip() or name}" for tag, name in names.items()}
        yield WrenchSystem(
            **{tag: f"/{topic.strip('/')}" for tag, topic in topics.items()},
            persistent=tuple(_persistent(reader, plugin, lost)),
        )


def _persistent(reader: XmlReader, plugin: etree._Element, lost: Callable[[InputError], None]) -> Iterator[LinkWrench]:
    for element in plugin.findall("persistent"):
        try:
            yield _wrench(reader, element)
        except InputError as error:
            lost(error)


def _wrench(reader: XmlReader, element: etree._Element) -> LinkWrench:
    entity, kind = ((element.findtext(tag) or "").strip() for tag in ("entity_name", "entity_type"))
    if not entity:
        raise reader.error(element, "<persistent> needs an <entity_name>")
    if kind not in _TYPES:
        raise reader.error(element, f"<entity_type> is {kind!r}", value=kind, valid=_TYPES)

    def vector(tag: str) -> Vector3:
        found = element.find(tag)
        if found is None or not (found.text or "").strip():
            return 0.0, 0.0, 0.0
        x, y, z = reader.parse_numbers(found, found.text or "", tag, 3)
        return x, y, z

    return LinkWrench(entity, vector("force"), vector("torque"))
