"""Which models are performers, and the regions that tell when one is inside, as gz-sim has them, as plain data."""

from collections.abc import Iterator
from dataclasses import field

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import CannotWorkError, PluginReader
from drake_twin.description.plugin_element import PluginElement
from drake_twin.findings import Place
from drake_twin.values import parse_number

PERFORMER = "drake_twin_performer"  # the library of the twin's own plugin of a model that is a performer

Vector3 = tuple[float, float, float]


@dataclass(frozen=True)
class Performer:
    """A model that detectors notice.

    Attributes:
        name: Its name as a performer.
        model: The model.
        size: The sides of its box, along the axes of the world and with the model's origin in the middle (m).
        place: Where it was written.
    """

    name: str
    model: str
    size: Vector3
    place: Place = field(default=Place(""), compare=False)


@dataclass(frozen=True)
class PerformerDetector:
    """A region that tells when a performer comes and goes.

    Attributes:
        topic: The topic of gz's transport, with a leading slash; ``{model}`` stands for the model.
        size: The sides of the region, along the axes of the world (m).
        offset: The place of its middle in the model's frame (m).
        header: Further entries of its messages' headers: keys and values, sorted by key.
    """

    topic: str
    size: Vector3
    offset: Vector3 = (0.0, 0.0, 0.0)
    header: tuple[tuple[str, str], ...] = ()


def read_performers(plugin: PluginReader) -> tuple[Performer, ...]:
    """Read the performers of gz-sim's own plugin of a world, which has levels, too: here all of them are there.

    Raises:
        CannotWorkError: If a performer has no model or no box.
        InputError: If a value is invalid; with file and line.
    """
    for tag in plugin.plugin.elements:
        if tag.partition("/")[0] in ("level", "use_levels") or tag.startswith("performer/geometry/box/"):
            plugin.has(tag)
    plugin.has("performer/ref")
    found: dict[str, Performer] = {}
    for element in plugin.plugin.tree:
        if element.tag != "performer":
            continue
        model = next((item.text for item in element.inside if item.tag == "ref"), "")
        if not model:
            raise CannotWorkError("a <performer> has no <ref>")
        performer = Performer(element.attributes.get("name", ""), model, _box(plugin, element), plugin.plugin.place)
        if model in found:
            raise CannotWorkError(f"{found[model].name} and {performer.name} are performers of one model, {model}")
        found[model] = performer
    return tuple(found.values())


def read_own_performer(plugin: PluginReader) -> Performer:
    """Read the twin's own plugin of a model that is a performer, as `drake_twin.description.breadcrumbs` writes it.

    Raises:
        CannotWorkError: If it has no box.
        InputError: If a value is invalid; with file and line.
    """
    plugin.has("geometry/box/size")
    return Performer("", "", _box(plugin, PluginElement("plugin", {}, "", plugin.plugin.tree)), plugin.plugin.place)


def check_volume(plugin: PluginReader, volume: PluginElement) -> None:
    """Check the ``<performer_volume>`` of a plugin.

    Raises:
        CannotWorkError: If it has no box.
        InputError: If a value is invalid; with file and line.
    """
    _box(plugin, volume)


def read_performer_detector(plugin: PluginReader) -> PerformerDetector:
    """Read ``gz-sim-performer-detector-system``.

    Raises:
        CannotWorkError: If it has no box.
        InputError: If a value is invalid; with file and line.
    """
    for tag in ("geometry/box/size", "header_data", "header_data/key", "header_data/value"):
        plugin.has(tag)
    whole = PluginElement("plugin", {}, "", plugin.plugin.tree)
    offset = _numbers(plugin, "pose", plugin.text("pose", "0 0 0 0 0 0"), 6)[:3]
    topic = plugin.text("topic", "/model/{model}/performer_detector/status").strip("/")
    header = tuple(sorted(dict(_entries(plugin)).items()))
    return PerformerDetector(f"/{topic}", _box(plugin, whole), _three(offset), header)


def _entries(plugin: PluginReader) -> Iterator[tuple[str, str]]:
    """Yield the keys and values of the header; entries without one of them are left out, as in gz-sim."""
    for element in plugin.plugin.tree:
        if element.tag == "header_data":
            key, value = (
                next((item.text for item in element.inside if item.tag == tag), "") for tag in ("key", "value")
            )
            if key and value:
                yield key, value


def _box(plugin: PluginReader, element: PluginElement) -> Vector3:
    for tag in ("geometry", "box"):
        found = next((item for item in element.inside if item.tag == tag), None)
        if found is None:
            raise CannotWorkError("<geometry> with a <box> is missing")
        element = found
    text = next((item.text for item in element.inside if item.tag == "size"), "1 1 1")
    size = _three(_numbers(plugin, "size", text, 3))
    if min(size) < 0.0:
        raise plugin.error(f"<size> is {text!r}, and has to be three numbers of zero or more")
    return size


def _numbers(plugin: PluginReader, tag: str, text: str, count: int) -> list[float]:
    try:
        values = [parse_number(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count:
        raise plugin.error(f"<{tag}> is {text!r}, which is not {count} finite numbers")
    return values


def _three(values: list[float]) -> Vector3:
    x, y, z = values
    return x, y, z
