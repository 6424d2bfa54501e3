"""What a world has beside its models: where on Earth it is, its magnetic field, its lights, its wind."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Vector3
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.values import is_true


@dataclass(frozen=True)
class SphericalCoordinates:
    """Where the origin of a world is, on the ellipsoid WGS 84.

    Attributes:
        latitude: Degrees north.
        longitude: Degrees east.
        elevation: Above the ellipsoid (m).
        heading: The angle from east to the world's x axis, counterclockwise from above (degrees).
    """

    latitude: float = 0.0
    longitude: float = 0.0
    elevation: float = 0.0
    heading: float = 0.0


@dataclass(frozen=True)
class Light:
    """A light.

    Attributes:
        kind: ``directional``, ``point`` or ``spot``.
        position: In the world (m).
        direction: Where it shines, in the world.
        color: Red, green, blue (0 to 1).
        intensity: Multiplies the color.
        attenuation: The factors of distance⁰, distance¹ (1/m) and distance² (1/m²) by which it is divided.
        cone_angle: The whole angle of a spot (rad).
        casts_shadows: Whether there are shadows; never of a point.
    """

    kind: str = "directional"
    position: Vector3 = (0.0, 0.0, 10.0)
    direction: Vector3 = (-0.5, 0.1, -0.9)
    color: Vector3 = (0.8, 0.8, 0.8)
    intensity: float = 1.0
    attenuation: Vector3 = (1.0, 0.0, 0.0)
    cone_angle: float = 0.0
    casts_shadows: bool = True


SUN = Light()  # model://sun


@dataclass(frozen=True)
class Surroundings:
    """What a world file says for sensors, and of the air.

    Attributes:
        spherical: Where on Earth its origin is; None if the file does not say so.
        magnetic_field: In the world frame (T); SDF's default.
        lights: Its lights; the sun without a file.
        background: The color of the sky: red, green, blue (0 to 1); SDF's default.
        wind: The velocity of the air, in the world frame (m/s).
    """

    spherical: SphericalCoordinates | None = None
    magnetic_field: Vector3 = (5.5645e-6, 22.8758e-6, -42.3884e-6)
    lights: tuple[Light, ...] = (SUN,)
    background: Vector3 = (0.7, 0.7, 0.7)
    wind: Vector3 = (0.0, 0.0, 0.0)


def read_surroundings(
    reader: XmlReader,
    world: etree._Element,
    included: Iterable[tuple[etree._Element, XmlReader]],
    lost: Callable[[InputError], None],
) -> Surroundings:
    """Read ``<spherical_coordinates>``, ``<magnetic_field>``, ``<scene>``, ``<wind>`` and the lights of a world.

    Args:
        reader: The world's document.
        world: Its ``<world>``.
        included: Lights of other files that it includes, each with its document.
        lost: Is told what is wrong with an element that cannot be used: it is left out.
    """
    own = ((element, reader) for element in world.findall("light"))
    found = Surroundings(lights=tuple(_lights((*own, *included), lost)))
    if not is_true(world.findtext("scene/shadows", "true")):
        found = replace(found, lights=tuple(replace(light, casts_shadows=False) for light in found.lights))
    parts: dict[str, Callable[[etree._Element], dict[str, Any]]] = {
        "scene/background": lambda element: {"background": _vector(reader, element)},
        "magnetic_field": lambda element: (
            {"magnetic_field": _vector(reader, element)} if (element.text or "").strip() else {}
        ),
        "wind/linear_velocity": lambda element: (
            {"wind": _velocity(reader, element)} if (element.text or "").strip() else {}
        ),
        "spherical_coordinates": lambda element: {"spherical": _spherical(reader, element)},
    }
    for path, read in parts.items():
        element = world.find(path)
        if element is not None:
            try:
                found = replace(found, **read(element))
            except InputError as error:
                lost(error)
    return found


def _lights(
    elements: Iterable[tuple[etree._Element, XmlReader]], lost: Callable[[InputError], None]
) -> Iterator[Light]:
    for element, document in elements:
        try:
            yield read_light(element, document)
        except InputError as error:
            lost(error)


def _spherical(reader: XmlReader, place: etree._Element) -> SphericalCoordinates:
    surface = (place.findtext("surface_model") or "EARTH_WGS84").strip()
    if surface != "EARTH_WGS84":
        raise reader.error(place, f"unknown surface_model {surface!r}", value=surface, valid=("EARTH_WGS84",))
    tags = ("latitude_deg", "longitude_deg", "elevation", "heading_deg")
    texts = {tag: (place.findtext(tag) or "").strip() for tag in tags}
    values = [reader.parse_number(place, text, tag) if text else 0.0 for tag, text in texts.items()]
    if abs(values[0]) > 90.0:
        raise reader.error(place, f"latitude_deg is {texts['latitude_deg']!r}, but it must be -90 to 90")
    return SphericalCoordinates(*values)


def read_light(element: etree._Element, reader: XmlReader) -> Light:
    """Read a ``<light>``.

    Raises:
        InputError: If a value is not a finite number, or the type is unknown.
    """
    from drake_twin.description.sdf_pose import transform_of

    kinds = ("directional", "point", "spot")
    kind = (element.get("type") or "point").strip()
    if kind not in kinds:
        raise reader.error(element, f"unknown light type {kind!r}", value=kind, valid=kinds)

    def numbers(path: str, default: Vector3) -> Vector3:
        found = element.find(path)
        return default if found is None or not (found.text or "").strip() else _vector(reader, found)

    def number(path: str, default: float) -> float:
        found = element.find(path)
        text = "" if found is None else (found.text or "").strip()
        return default if found is None or not text else reader.parse_number(found, text, path)

    pose = element.find("pose")
    X_WL = None if pose is None else transform_of(pose, reader)
    direction = numbers("direction", (0.0, 0.0, -1.0))
    position: Vector3 = (0.0, 0.0, 0.0)
    if X_WL is not None:
        x, y, z = (X_WL.rotation() @ list(direction)).tolist()
        direction, position = (x, y, z), tuple(X_WL.translation().tolist())
    if not any(direction):
        raise reader.error(element, "the direction of a light cannot be 0 0 0")
    return Light(
        kind=kind,
        position=position,
        direction=direction,
        color=numbers("diffuse", (1.0, 1.0, 1.0)),
        intensity=number("intensity", 1.0),
        attenuation=(
            number("attenuation/constant", 1.0),
            number("attenuation/linear", 1.0 if element.find("attenuation") is not None else 0.0),
            number("attenuation/quadratic", 0.0),
        ),
        cone_angle=number("spot/outer_angle", 0.0),
        casts_shadows=is_true(element.findtext("cast_shadows")),
    )


def _velocity(reader: XmlReader, element: etree._Element) -> Vector3:
    x, y, z = reader.parse_numbers(element, element.text or "", str(element.tag), 3)
    return x, y, z


def _vector(reader: XmlReader, element: etree._Element) -> Vector3:
    """Read three numbers; the fourth of a color is its opacity."""
    words = (element.text or "").split()
    x, y, z = reader.parse_numbers(element, " ".join(words[:3]), str(element.tag), 3)
    return x, y, z
