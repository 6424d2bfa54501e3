"""The surfaces that ``<gazebo reference="link">`` gives shapes of a URDF's links, and which links of SDF collide."""

from collections import defaultdict
from dataclasses import replace

from lxml import etree

from drake_twin.dataclass import dataclass
from drake_twin.description.fixed_joint_lumping import gazebo_collisions, link_families
from drake_twin.description.gazebo_tag import is_yes, text_or_value
from drake_twin.description.xml_reader import XmlReader
from drake_twin.values import is_true

# Below a link of SDF, and below a URDF's <gazebo reference>, whose <collision> Gazebo merges into the link's.
SURFACE_FRICTION = "collision/surface/friction/ode"


@dataclass(frozen=True)
class Friction:
    """The coefficients of friction of a collision shape along its two directions, without unit; SDF's defaults."""

    mu: float = 1.0
    mu2: float = 1.0


@dataclass(frozen=True)
class LinkSurface:
    """The contact properties of a link.

    Attributes:
        frictions: The friction of each of its collision shapes, in file order; None where the file gives none. Empty
            if it gives none at all.
        self_collide: Whether its shapes touch those of other links of the robot; None where the file does not tell.
    """

    frictions: tuple[Friction | None, ...] = ()
    self_collide: bool | None = None


def link_surfaces(reader: XmlReader) -> dict[str, LinkSurface]:
    """Read the surfaces of a URDF's links.

    As in Gazebo, a ``<gazebo reference>`` is about those collision shapes that have no name of their own; see
    `gazebo_collisions`.

    Raises:
        InputError: If a coefficient is not a number.
    """
    tags: defaultdict[str, list[etree._Element]] = defaultdict(list)
    for element in reader.root.iterfind("gazebo[@reference]"):
        tags[element.get("reference", "").strip()].append(element)
    for element in (tag for found in tags.values() for tag in found):
        _with_friction_of(element, None, reader)  # a wrong number is wrong on any link
    frictions: defaultdict[str, dict[int, Friction | None]] = defaultdict(dict)
    for (link, index), shape in gazebo_collisions(reader.root).items():
        friction: Friction | None = None
        for element in (tag for source in shape.sources for tag in tags.get(source, ())):
            friction = _with_friction_of(element, friction, reader)
        frictions[link][index] = friction
    surfaces: dict[str, LinkSurface] = {}
    for family in link_families(reader.root).values():
        flags = [_self_collide(tag) for link in family for tag in tags.get(link, ())]
        given = [flag for flag in flags if flag is not None]  # what is folded together is one link in Gazebo
        for link in family:
            own = tuple(friction for _, friction in sorted(frictions[link].items()))
            surface = LinkSurface(own if any(own) else (), given[-1] if given else None)
            if surface != LinkSurface():
                surfaces[link] = surface
    return surfaces


def sdf_surfaces(model: etree._Element) -> dict[str, LinkSurface]:
    """Read which links of an SDF model touch others of it; Drake's parser reads the friction of their shapes.

    A link without ``<self_collide>`` has the model's. Between a link and its parent nothing collides.
    """
    of_model = model.findtext("self_collide")
    flags = {link.get("name", ""): link.findtext("self_collide") or of_model for link in model.iterfind("link")}
    return {name: LinkSurface(self_collide=True) for name, flag in flags.items() if is_true(flag)}


def _with_friction_of(element: etree._Element, friction: Friction | None, reader: XmlReader) -> Friction | None:
    """Return a friction as a ``<gazebo reference>`` changes it: ``<surface>`` first, then ``<mu1>`` and ``<mu2>``."""
    for surface in element.iterfind("collision/surface"):
        found = {"mu": surface.findtext("friction/ode/mu"), "mu2": surface.findtext("friction/ode/mu2")}
        numbers = {name: _coefficient(reader, surface, text.strip(), name) for name, text in found.items() if text}
        friction = Friction(**numbers) if numbers else None
    for tag, name in (("mu1", "mu"), ("mu2", "mu2")):
        text = text_or_value(element, tag)
        if text is not None:
            value = _coefficient(reader, element, text, tag)
            friction = replace(friction or Friction(), **{name: value})
    return friction


def _coefficient(reader: XmlReader, element: etree._Element, text: str, name: str) -> float:
    value = reader.parse_number(element, text, name)
    if value < 0:
        raise reader.error(element, f"{name} is {value:g}, and it cannot be negative")
    return value


def _self_collide(element: etree._Element) -> bool | None:
    converted, own = text_or_value(element, "selfCollide"), text_or_value(element, "self_collide")
    if converted is not None:
        return is_yes(converted)
    return None if own is None else is_true(own)
