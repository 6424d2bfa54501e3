"""Contact parameters in files that have no effect in the twin, each reported once.

Of a surface the twin uses the smallest coefficient of friction. The stiffness of contact follows from the masses.
"""

import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from lxml import etree

from drake_twin.description.fixed_joint_lumping import gazebo_collisions
from drake_twin.description.xml_reader import XmlReader
from drake_twin.findings import Cause, Finding, Kind, Place, Weight, at_places, first_of

_STIFFNESS = "stiffness and damping of contact follow from the masses"
_ISOTROPY = "friction is the same in all directions"
_SLIP = "nothing slips below its limit of friction"
_ROLLING = "rolling has no resistance but friction"
_TORSION = "only contact between faces resists a turn on the spot"
_BOUNCE = "nothing bounces"
_MASKS = "shapes of different models always collide"
_NAMED = "without effect on collision shapes that have a name: Gazebo's reader gives those the default surface"
_FOLDED = "without effect: Gazebo's reader takes the link's shapes for those of the link that it is fixed to"
_SHAPELESS = "without effect: the link has no collision shape"

# Parameter → Gazebo's default, and what the twin does instead.
_UNUSED: Mapping[str, tuple[tuple[float, ...], str]] = {
    "kp": ((1e12,), _STIFFNESS),
    "kd": ((1.0,), _STIFFNESS),
    "soft_cfm": ((0.0,), _STIFFNESS),
    "soft_erp": ((0.2,), _STIFFNESS),
    "min_depth": ((0.0,), _STIFFNESS),
    "max_vel": ((0.01,), _STIFFNESS),
    "fdir1": ((0.0, 0.0, 0.0), _ISOTROPY),
    "slip1": ((0.0,), _SLIP),
    "slip2": ((0.0,), _SLIP),
    "rolling_friction": ((0.0,), _ROLLING),
    "patch_radius": ((0.0,), _TORSION),
    "surface_radius": ((0.0,), _TORSION),
    "restitution_coefficient": ((0.0,), _BOUNCE),
    "collide_without_contact": ((0.0,), _MASKS),
    "collide_bitmask": ((65535.0,), _MASKS),
    "category_bitmask": ((65535.0,), _MASKS),
}
# What gz-physics does not give to DART either (dartsim/src/SDFFeatures.cc).
_NOT_IN_DART = {"kp", "kd", "soft_cfm", "soft_erp", "min_depth", "max_vel", "rolling_friction"}
_NOT_IN_DART |= {"patch_radius", "surface_radius", "collide_without_contact"}
_COEFFICIENTS = ("mu", "mu1", "mu2")
_MOST_NAMED = 6  # links in a sentence
_NEVER_THE_SMALLER = 10.0  # of the two coefficients of a pair, in practice


def parameter(element: etree._Element) -> str:
    """Return an element's name as SDF has it: URDF's ``<gazebo>`` also knows ``minDepth``."""
    name = element.tag if isinstance(element.tag, str) else ""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def is_unused(element: etree._Element) -> bool:
    """Tell whether an element is one of these parameters."""
    return parameter(element) in _UNUSED


def unused_in_urdf(reader: XmlReader, rollers: Collection[str] = ()) -> list[Finding]:
    """Report the contact parameters of ``<gazebo reference="link">`` that have no effect, with the links' names.

    Args:
        reader: The robot's document.
        rollers: The links whose direction of friction is used.
    """
    shapes = gazebo_collisions(reader.root)
    told = {source for shape in shapes.values() for source in shape.sources}
    own = {link.get("name", "").strip(): link.findall("collision") for link in reader.root.iterfind("link")}
    untold = {place for place, shape in shapes.items() if place[0] not in shape.sources}
    named = {link for link, index in untold if own[link][index].get("name")}
    folded = {link for link, index in untold if not own[link][index].get("name")}
    bare = {link for link, collisions in own.items() if not collisions} - told
    surfaces: dict[str, list[etree._Element]] = {}
    for element in reader.root.iterfind("gazebo[@reference]"):
        inside = surfaces.setdefault(element.get("reference", ""), [])
        inside += [*element, *element.iterfind("collision/surface//*")]
    used = {link: elements for link, elements in surfaces.items() if link in told}
    return [
        *_findings(reader, used.items(), rollers),
        *_together(reader, _asked(surfaces, named, _NAMED)),
        *_together(reader, _asked(surfaces, folded, _FOLDED)),
        *_together(reader, _asked(surfaces, bare, _SHAPELESS)),
    ]


def _asked(
    surfaces: Mapping[str, Sequence[etree._Element]], links: Collection[str], why: str
) -> Iterator[tuple[str, etree._Element, str]]:
    """Yield link, parameter and why it has no effect, for all parameters of links that are not Gazebo's defaults."""
    for link in (each for each in surfaces if each in links):
        for element in surfaces[link]:
            name, values = parameter(element), _values(element)
            default = (1.0,) if name in _COEFFICIENTS else _UNUSED[name][0] if name in _UNUSED else None
            if default is not None and values not in (default, ()):
                yield link, element, why


def unused_in_sdf(
    reader: XmlReader, model: etree._Element, *, with_links: bool, rollers: Collection[str] = ()
) -> list[Finding]:
    """Report the contact parameters of a model's collisions that have no effect.

    Args:
        reader: The document that it is in.
        model: The model.
        with_links: Whether to name its links.
        rollers: The links whose direction of friction is used, if they are named.
    """
    surfaces = [
        (link.get("name", "") if with_links else "", [*surface.iter()])
        for link in model.iter("link")
        for surface in link.iterfind("collision/surface")
    ]
    return list(_findings(reader, surfaces, rollers))


def _findings(
    reader: XmlReader, surfaces: Iterable[tuple[str, Sequence[etree._Element]]], rollers: Collection[str]
) -> Iterator[Finding]:
    yield from _together(
        reader,
        (
            (link, element, f"without effect: {instead}")
            for link, elements in surfaces
            for element, instead in _found(elements)
            if link not in rollers or not instead.startswith(_ISOTROPY)
        ),
    )


def _together(reader: XmlReader, unused: Iterable[tuple[str, etree._Element, str]]) -> Iterator[Finding]:
    """Make a finding for each kind of effect, with all parameters and links that it is about."""
    found: dict[str, list[tuple[str, str, Place]]] = defaultdict(list)
    for link, element, effect in unused:
        found[effect].append((parameter(element), link, reader.place(element)))
    for effect, about in found.items():
        names, links, places = (list(dict.fromkeys(column)) for column in zip(*about, strict=True))
        links = [link for link in links if link]
        whose = f" of {first_of(links, _MOST_NAMED)}" if links else ""
        weight = Weight.LOOKS if _NOT_IN_DART.issuperset(names) else Weight.MOVES
        what = f"{', '.join(names)}{whose}: {effect}"
        told = ((what, place) for place in places)
        yield from at_places(Kind.WARNING, told, weight=weight, cause=Cause.CONTACT)


def _has_no_effect(name: str, values: Sequence[float], elements: Iterable[etree._Element]) -> bool:
    """Tell whether a parameter changes nothing in Gazebo either, for the others that stand beside it.

    Masks with the lowest bit let shapes collide, for that bit is set wherever a mask is not another layer's. A
    direction of friction needs two coefficients or a slip.
    """
    if name in ("collide_bitmask", "category_bitmask"):
        return len(values) == 1 and values[0] % 2 == 1
    if name != "fdir1":
        return False
    beside = {parameter(element): _values(element) for element in elements}
    first, second = beside.get("mu1", beside.get("mu", (1.0,))), beside.get("mu2", (1.0,))
    return first == second and not any(any(beside.get(slip, ())) for slip in ("slip1", "slip2"))


def _found(elements: Sequence[etree._Element]) -> Iterator[tuple[etree._Element, str]]:
    """Yield the parameters of a surface that would have an effect in Gazebo, and what the twin does instead."""
    coefficients: dict[float, etree._Element] = {}
    for element in elements:
        name, values = parameter(element), _values(element)
        if name in _COEFFICIENTS and len(values) == 1:
            coefficients.setdefault(values[0], element)
        elif name in _UNUSED and values != _UNUSED[name][0] and not _has_no_effect(name, values, elements):
            yield element, _UNUSED[name][1]
    smallest = min(coefficients, default=0.0)
    if smallest < _NEVER_THE_SMALLER:
        for value, element in coefficients.items():
            if value != smallest:
                yield element, f"{_ISOTROPY}, and the smaller coefficient counts"


def _values(element: etree._Element) -> tuple[float, ...]:
    """Return the numbers in an element, or in its attribute ``value``; nothing where it holds anything else."""
    words = (element.get("value") or element.text or "").lower().split()
    try:
        return tuple(map(_number, words))
    except ValueError:
        return ()


def _number(word: str) -> float:
    if word in ("true", "false"):
        return float(word == "true")
    return float(int(word, 16)) if word.startswith("0x") else float(word)
