"""What the sensors of a world measure beside its models: where on Earth it is, and its magnetic field."""

from dataclasses import dataclass

from lxml import etree

from drake_twin.description.robot_description import Vector3
from drake_twin.description.xml_reader import XmlReader


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
class Surroundings:
    """What a world file says for its sensors.

    Attributes:
        spherical: Where on Earth its origin is; None if the file does not say so.
        magnetic_field: In the world frame (T); SDF's default.
    """

    spherical: SphericalCoordinates | None = None
    magnetic_field: Vector3 = (5.5645e-6, 22.8758e-6, -42.3884e-6)


def read_surroundings(reader: XmlReader, world: etree._Element) -> Surroundings:
    """Read ``<spherical_coordinates>`` and ``<magnetic_field>`` of a world.

    Raises:
        InputError: If a value is not a finite number, a latitude is beyond a pole, or the surface is not WGS 84.
    """
    field = world.find("magnetic_field")
    surroundings = Surroundings()
    if field is not None and (field.text or "").strip():
        x, y, z = reader.parse_numbers(field, field.text or "", "magnetic_field", 3)
        surroundings = Surroundings(magnetic_field=(x, y, z))
    place = world.find("spherical_coordinates")
    if place is None:
        return surroundings
    surface = (place.findtext("surface_model") or "EARTH_WGS84").strip()
    if surface != "EARTH_WGS84":
        raise reader.error(place, f"unknown surface_model {surface!r}", value=surface, valid=("EARTH_WGS84",))
    tags = ("latitude_deg", "longitude_deg", "elevation", "heading_deg")
    texts = {tag: (place.findtext(tag) or "").strip() for tag in tags}
    values = [reader.parse_number(place, text, tag) if text else 0.0 for tag, text in texts.items()]
    if abs(values[0]) > 90.0:
        raise reader.error(place, f"latitude_deg is {texts['latitude_deg']!r}, but it must be -90 to 90")
    return Surroundings(SphericalCoordinates(*values), surroundings.magnetic_field)
