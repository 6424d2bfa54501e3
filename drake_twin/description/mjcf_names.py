"""What of an MJCF file is not in MuJoCo's schema: MuJoCo refuses it, and Drake's parser is silent."""

from collections.abc import Iterator, Mapping

from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import did_you_mean
from drake_twin.findings import Finding, Kind, at_places
from drake_twin.values import needed

_ANYWHERE = ("include", "plugin", "config")
_FRAME = "pos quat axisangle xyaxes zaxis euler"
_DRIVE = (
    "armature class cranklength cranksite ctrllimited ctrlrange damping delay forcelimited forcerange gear group interp"
    " joint jointinparent lengthrange name nsample refsite site slidersite tendon user"
)
_ACTUATORS = (
    *("general", "motor", "position", "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder", "muscle"),
    *("adhesion", "dcmotor"),
)
_IN_BODY = (
    *("body", "inertial", "joint", "freejoint", "geom", "site", "camera", "light", "composite", "flexcomp", "frame"),
    *("attach", "replicate"),
)

# Element → the elements in it, where one with another name would be lost in silence.
_CHILDREN: Mapping[str, tuple[str, ...]] = {
    "mujoco": (
        *("compiler", "option", "size", "visual", "statistic", "default", "custom", "extension", "asset", "worldbody"),
        *("contact", "deformable", "equality", "tendon", "actuator", "sensor", "keyframe"),
    ),
    "default": (
        *("default", "mesh", "material", "texture", "joint", "geom", "site", "camera", "light", "pair", "equality"),
        *("tendon", *_ACTUATORS),
    ),
    "worldbody": _IN_BODY,
    "body": _IN_BODY,
    "frame": _IN_BODY,
    "asset": ("mesh", "hfield", "skin", "texture", "material", "model"),
    "contact": ("pair", "exclude"),
    "actuator": _ACTUATORS,
}

# Element → its attributes, of those that say how the robot moves.
_ATTRIBUTES: Mapping[str, frozenset[str]] = {
    tag: frozenset(names.split())
    for tag, names in {
        "compiler": "alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict convexhull"
        " coordinate discardvisual eulerseq exactmeshinertia fitaabb fusestatic inertiafromgeom inertiagrouprange"
        " meshdir passthrough savecanonical savecompiled saveinertial settotalmass strippath texturedir usethread",
        "body": f"name childclass mocap gravcomp sleep simple fuse user {_FRAME}",
        "inertial": f"mass diaginertia fullinertia {_FRAME}",
        "joint": "actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss group"
        " limited margin name pos range ref solimpfriction solimplimit solreffriction solreflimit springdamper"
        " springref springyield stiffness type user",
        "freejoint": "align group name",
        "geom": "adhesion castshadow class conaffinity condim contype density fitscale fluidcoef fluidshape friction"
        " fromto gap group hfield margin mass material mesh name priority rgba shellinertia size solimp solmix solref"
        f" surfacevel type user {_FRAME}",
        "mesh": "builtin class content_type face file inertia material maxhullvert name normal params refpos refquat"
        " scale smoothnormal texcoord vertex",
        "motor": _DRIVE,
        "position": f"{_DRIVE} dampratio inheritrange kp kv timeconst",
        "velocity": f"{_DRIVE} kv",
        "general": f"{_DRIVE} actdim actearly actlimited actrange biasprm biastype body dynprm dyntype ffrange gainprm"
        " gaintype inheritrange input velrange",
        "pair": "adhesion class condim friction gap geom1 geom2 margin name solimp solref solreffriction",
        "exclude": "body1 body2 name",
    }.items()
}

# Attribute → how many numbers it has at least and at most.
_NUMBERS: Mapping[str, tuple[int, int]] = {
    **dict.fromkeys(("pos", "axis", "euler", "zaxis", "diaginertia", "scale"), (3, 3)),
    **dict.fromkeys(("quat", "axisangle"), (4, 4)),
    **dict.fromkeys(("fromto", "xyaxes", "fullinertia"), (6, 6)),
    **dict.fromkeys(("range", "ctrlrange", "forcerange", "actuatorfrcrange"), (2, 2)),
    **dict.fromkeys(("mass", "density", "armature", "frictionloss", "springref", "kp", "kv"), (1, 1)),
    **dict.fromkeys(("damping", "stiffness"), (1, 1)),  # MuJoCo 4's polynomials are not modelled
    "size": (1, 3),
    "friction": (1, 5),
    "gear": (1, 6),
}
_JOINT_TYPES = ("free", "ball", "slide", "hinge")
# Type of a geom → the numbers of its size, without `fromto`.
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_GEOM_TYPES = ("plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf")


def unknown_mjcf_names(reader: XmlReader) -> list[Finding]:
    """Report the elements and attributes that MuJoCo's schema does not have, each once with its lines.

    Raises:
        InputError: If a value is not as many finite numbers as its attribute has, or a type is unknown.
    """
    _check_names(reader)
    return list(at_places(Kind.IGNORED, ((what, reader.place(element)) for element, what in _unknown(reader))))


def _unknown(reader: XmlReader) -> Iterator[tuple[etree._Element, str]]:
    for name in (name for name in map(str, reader.root.attrib) if name != "model"):
        yield reader.root, f"the attribute {name} of <mujoco>{did_you_mean(name, ('model',))}"
    for element in reader.root.iter(etree.Element):
        above = element.getparent()
        children = None if above is None else _CHILDREN.get(str(above.tag))
        if above is None or children is None:
            continue
        if element.tag not in (*children, *_ANYWHERE):
            yield element, f"<{element.tag}> in <{above.tag}>{did_you_mean(element.tag, children)}"
            continue
        known = _ATTRIBUTES.get(str(element.tag), frozenset(map(str, element.attrib)))
        for name in map(str, element.attrib):
            if name not in known and not name.startswith("{"):
                yield element, f"the attribute {name} of <{element.tag}>{did_you_mean(name, sorted(known))}"
            elif name in _NUMBERS:
                _check_numbers(reader, element, name)
        types = {"joint": _JOINT_TYPES, "geom": _GEOM_TYPES}.get(str(element.tag))
        kind = element.get("type", "")
        if types and kind and kind not in types:
            raise reader.error(element, f"unknown type {kind!r}", value=kind, valid=types)
        if element.tag == "geom":
            _check_geom(reader, element)


def _check_names(reader: XmlReader) -> None:
    """Refuse what has the name of another of its kind, as MuJoCo does."""
    for kinds in (("body",), ("joint", "freejoint"), ("geom",), ("site",), _ACTUATORS):
        taken: set[str] = set()
        section = "actuator" if kinds is _ACTUATORS else "worldbody"
        for element in (item for part in reader.root.findall(section) for item in part.iter(*kinds)):
            name = element.get("name", "")
            if name and name in taken:
                raise reader.error(element, f"another {element.tag} has this name")
            taken.add(name)


def _check_geom(reader: XmlReader, geom: etree._Element) -> None:
    """Check the mass and the size of a geom, where no default class gives it another type."""
    if reader.number(geom, "mass", 0.0) < 0:
        raise reader.error(geom, f"mass is {geom.get('mass')!r}, and it cannot be negative")
    is_whole = "type" in geom.attrib and "size" in geom.attrib
    has_defaults = not is_whole and next(reader.root.iterfind("default//geom"), None) is not None
    count = _SIZES.get(geom.get("type", "sphere"), 0)
    if has_defaults or "fromto" in geom.attrib or geom.get("mesh") or "include" in {item.tag for item in reader.root}:
        return
    if len(geom.get("size", "").split()) < count:
        size = f"size is {geom.get('size')!r}" if "size" in geom.attrib else "it has no size"
        raise reader.error(geom, f"{size}, but a {geom.get('type', 'sphere')} needs {count} of them")


def _check_numbers(reader: XmlReader, element: etree._Element, name: str) -> None:
    words = element.get(name, "").split()
    least, most = _NUMBERS[name]
    if least <= len(words) <= most:
        for word in words:
            reader.parse_number(element, word, name)
        return
    how = needed(least) if least == most else f"{least} to {most} numbers are needed"
    raise reader.error(element, f"{name} is {element.get(name)!r}, where {how}")
