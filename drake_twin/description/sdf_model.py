"""A ``<model>`` of an SDF world made ready for Drake's parser: what it cannot use is left out, and said to be.

Each rule is one function on the XML tree of the file that the model stands in, applied by `mend_model`.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from math import isfinite
from pathlib import Path

import numpy as np
from lxml import etree

from drake_twin.description.caster_balls import weld_caster_balls
from drake_twin.description.gazebo_colors import GAZEBO_COLORS
from drake_twin.description.meshes import collision_mesh, mesh_address, mesh_primitive, visual_mesh
from drake_twin.description.package_index import MissingPackageError
from drake_twin.description.repairs import possible_inertia
from drake_twin.description.sdf_includes import free_name
from drake_twin.description.sdf_pose import pose_transform
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind

_DRAKE_NAMESPACE = "http://drake.mit.edu"

_LEAST_MASS = 1e-3  # kg, as for robots

_KEPT = {
    "model": {"static", "pose", "link", "joint", "frame", "model"},
    "link": {"pose", "inertial", "collision", "visual", "kinematic", "gravity"},
    "joint": {"parent", "child", "pose", "axis", "axis2", "screw_thread_pitch", "thread_pitch"},
    "axis": {"xyz", "limit", "dynamics", "use_parent_model_frame", "mimic"},
    "axis2": {"xyz", "limit", "dynamics", "use_parent_model_frame", "mimic"},
    "collision": {"pose", "geometry", "surface"},
    "visual": {"pose", "geometry", "material", "transparency"},
}
# Of no effect on where things are; to name them would only be noise.
_SILENT = {"self_collide", "allow_auto_disable", "enable_wind", "velocity_decay", "must_be_base_link", "kinematic"}
_SILENT |= {"max_contacts", "laser_retro", "cast_shadows", "meta", "physics", "visibility_flags", "plugin_data"}
_SILENT |= {"density", "auto_inertia_params", "audio_sink", "lighting", "description", "origin", "pose_publish"}

_SIZES = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "ellipsoid": ("radii",),
}
_SHAPES = (*_SIZES, "plane", "mesh")

_LIMITLESS = ("ball", "universal", "screw")
_JOINTS = ("fixed", "revolute", "continuous", "prismatic", "planar", *_LIMITLESS)
_INFINITE = 1e16  # SDF's

FindFile = Callable[[str, Path | None], Path]


def mend_model(model: etree._Element, reader: XmlReader, find: FindFile) -> list[Finding]:
    """Changes a model so that Drake's parser takes it, except for the meshes and planes of what does not move.

    Args:
        model: the element, with its includes replaced.
        reader: the document it stands in.
        find: resolves an address in a file.

    Returns:
        What was left out and what was changed, each once.
    """
    unknown = Counter(_unknown_elements(model))
    found: Counter[str] = Counter()
    for rule in (_frames_of_old_poses, _names, _joints, _inertias, _shapes, _materials, _friction):
        found.update(rule(model))
    _flatten_planes(model)
    found.update(_meshes(model, reader, find))
    found.update(weld_caster_balls(model))
    for nested in [*model.iter("model")][:0:-1]:  # the innermost first
        parent = nested.getparent()
        if parent is not None and nested.find("link") is None and nested.find("model") is None:
            parent.remove(nested)
    return [*_counted(Kind.IGNORED, unknown), *_counted(Kind.WARNING, found)]


def _counted(kind: Kind, found: Mapping[str, int]) -> Iterator[Finding]:
    for what, count in found.items():
        yield Finding(kind, what + (f" ({count} times)" if count > 1 else ""))


def is_static(model: etree._Element) -> bool:
    """Whether ``<static>`` says that a model does not move, or that no model in it does where it has no own links."""
    if _is_true(model.find("static")):
        return True
    nested = model.findall("model")
    return bool(nested) and model.find("link") is None and all(map(is_static, nested))


def falls(model: etree._Element) -> bool:
    """Whether gravity acts on a model: not where all its links have ``<gravity>false``."""
    links = [*model.iter("link")]
    return not links or any(link.find("gravity") is None or _is_true(link.find("gravity")) for link in links)


def _is_true(element: etree._Element | None) -> bool:
    return element is not None and (element.text or "").strip().lower() in ("1", "true")


def _unknown_elements(model: etree._Element) -> Iterator[str]:
    falling = falls(model)
    for parent in [*model.iter(*_KEPT)]:
        for child in list(parent):
            if child.tag in _KEPT[str(parent.tag)]:
                continue
            parent.remove(child)
            if isinstance(child.tag, str) and child.tag not in _SILENT:
                named = child.get("filename") or child.get("type") or ""
                named = f" {Path(named).name}" if child.tag in ("plugin", "sensor") else ""
                yield f"<{etree.QName(child).localname}>{named} is not used"
    for inertial in model.iter("inertial"):
        for child in list(inertial):
            if child.tag not in ("mass", "inertia", "pose"):
                inertial.remove(child)
    for link in model.iter("link"):
        for flag in [*link.findall("gravity"), *link.findall("kinematic")]:
            link.remove(flag)
            if (
                (flag.tag == "gravity") != _is_true(flag)
                and not _within_static(link)
                and (falling or flag.tag != "gravity")
            ):
                yield f"<{flag.tag}>{(flag.text or '').strip()}</{flag.tag}> of a link is not used"


def _within_static(element: etree._Element) -> bool:
    return any(is_static(model) for model in element.iterancestors("model"))


def _frames_of_old_poses(model: etree._Element) -> Iterator[str]:
    """``<pose frame="…">`` never had a meaning in Gazebo, and newer parsers take it for one."""
    for pose in model.iter("pose"):
        pose.attrib.pop("frame", "")
        if not (pose.text or "").split():
            pose.text = "0 0 0 0 0 0"
    yield from ()


def _names(model: etree._Element) -> Iterator[str]:
    """What lacks a name, or has another's, is given one: names of shapes mean nothing to the twin.

    Gazebo classic saved models of models as one, with links named ``inner::link``, which newer parsers take apart.
    """
    for each in model.iter("model"):
        _rename_flattened(each)
    for link in model.iter("link"):
        for tag in ("collision", "visual"):
            taken: set[str] = set()
            for index, shape in enumerate(link.findall(tag)):
                if not shape.get("name", "").strip() or shape.get("name", "") in taken:
                    shape.set("name", f"{shape.get('name') or tag}_{index}")
                taken.add(shape.get("name", ""))
    yield from ()


def _rename_flattened(model: etree._Element) -> None:
    taken: set[str] = set()
    renamed: dict[str, str] = {}
    for child in model:
        if child.tag in ("link", "joint", "frame"):
            old = child.get("name", "")
            new = free_name(old.replace("::", "_"), taken) if "::" in old else old
            child.set("name", new)
            taken.add(new)
            if new != old:
                renamed.setdefault(old, new)
    for element in model.iter() if renamed else ():
        if element.tag in ("parent", "child") and (element.text or "").strip() in renamed:
            element.text = renamed[(element.text or "").strip()]
        for attribute in ("relative_to", "attached_to", "expressed_in"):
            if element.get(attribute) in renamed:
                element.set(attribute, renamed[element.get(attribute, "")])


def _joints(model: etree._Element) -> Iterator[str]:
    for joint in [*model.iter("joint")]:
        kind = joint.get("type", "")
        if _within_static(joint):
            _fix_for_good(joint)
        elif kind not in _JOINTS:
            joint.set("type", "fixed")
            yield f"joint {joint.get('name', '')} is fixed: Drake has no {kind or 'nameless'} joints"
        elif kind in _LIMITLESS and any(map(_is_bound, joint.iterfind("*/limit/*"))):
            yield f"joint {joint.get('name', '')} moves without limits: Drake has none for {kind} joints"
        for limit in joint.iterfind("axis/limit"):
            lower, upper = limit.find("lower"), limit.find("upper")
            low, high = _number(lower), _number(upper)
            if lower is not None and upper is not None and low is not None and high is not None and low > high:
                lower.text, upper.text = upper.text, lower.text
                yield f"joint {joint.get('name', '')}: lower {low:g} is above upper {high:g}: they change places"


def _is_bound(limit: etree._Element) -> bool:
    value = _number(limit)
    if value is None or limit.tag not in ("lower", "upper", "velocity") or abs(value) >= _INFINITE:
        return False
    return limit.tag != "velocity" or value >= 0  # a negative one is SDF's old default


def _fix_for_good(joint: etree._Element) -> None:
    """A joint of a static model says nothing, unless a pose is relative to it."""
    parent = joint.getparent()
    assert parent is not None
    name = joint.get("name")
    if any(pose.get("relative_to") == name for pose in parent.iter("pose")):
        joint.set("type", "fixed")
    else:
        parent.remove(joint)


def _inertias(model: etree._Element) -> Iterator[str]:
    for link in model.iter("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        if _within_static(link):
            link.remove(inertial)
            continue
        inertial.attrib.pop("auto", "")
        mass_element = inertial.find("mass")
        mass = 1.0 if mass_element is None else _number(mass_element)
        inertia = inertial.find("inertia")
        if mass is None or not isfinite(mass) or mass <= 0:
            for child in list(inertial):
                if child.tag != "pose":
                    inertial.remove(child)
            etree.SubElement(inertial, "mass").text = f"{_LEAST_MASS:g}"
            inertia, mass = etree.SubElement(inertial, "inertia"), _LEAST_MASS
            _set_inertia(inertia, possible_inertia(mass, np.zeros((3, 3)))[0])
            yield f"link {link.get('name', '')} moves, but has no mass: it weighs {_LEAST_MASS:g} kg"
        elif inertia is not None:
            tensor = _inertia(inertia)
            if tensor is not None:
                possible, why = possible_inertia(mass, tensor)
                if why is not None:
                    _set_inertia(inertia, possible)
                    yield f"link {link.get('name', '')}: {why}"


_MOMENTS = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}


def _inertia(element: etree._Element) -> np.ndarray | None:
    tensor = np.eye(3)  # SDF's default
    for name, (row, column) in _MOMENTS.items():
        child = element.find(name)
        value = tensor[row, column] if child is None else _number(child)
        if value is None or not isfinite(value):
            return None  # Drake's parser says so
        tensor[row, column] = tensor[column, row] = value
    return tensor


def _set_inertia(element: etree._Element, tensor: np.ndarray) -> None:
    for child in list(element):
        element.remove(child)
    for name, (row, column) in _MOMENTS.items():
        etree.SubElement(element, name).text = f"{float(tensor[row, column]):.17g}"


def _shapes(model: etree._Element) -> Iterator[str]:
    """Shapes that Drake has not, or of no size, are left out."""
    for shape in [*model.iter("collision", "visual")]:
        link, geometry = shape.getparent(), shape.find("geometry")
        assert link is not None
        kinds = [child for child in geometry if isinstance(child.tag, str)] if geometry is not None else []
        kind = kinds[0] if kinds else None
        reason = None
        if kind is None or kind.tag == "empty":
            reason = ""
        elif kind.tag not in _SHAPES:
            reason = f"a {shape.tag} of the shape <{kind.tag}> is left out: Drake has none"
        elif kind.tag in _SIZES and not all(_has_size(kind.find(tag)) for tag in _SIZES[str(kind.tag)]):
            reason = f"a {shape.tag} <{kind.tag}> has no size: it is left out"
        elif kind.tag == "plane" and shape.tag == "collision" and not _within_static(shape):
            reason = "a collision <plane> of a model that moves is left out: Drake has none"
        if reason is not None:
            link.remove(shape)
            if reason:
                yield reason


def _has_size(element: etree._Element | None) -> bool:
    sizes = [_value(part) for part in (element.text or "").split()] if element is not None else []
    return bool(sizes) and all(size is not None and isfinite(size) and size > 0 for size in sizes)


def _materials(model: etree._Element) -> Iterator[str]:
    """One colour a visual: ``<diffuse>``, else what Gazebo's material script stands for, else ``<ambient>``."""
    for visual in model.iter("visual"):
        color = None
        for material in visual.findall("material"):
            script = (material.findtext("script/name") or "").strip().rpartition("/")[2]
            color = material.findtext("diffuse") or GAZEBO_COLORS.get(script) or material.findtext("ambient")
            visual.remove(material)
        transparency = _number(visual.find("transparency")) or 0.0
        for element in visual.findall("transparency"):
            visual.remove(element)
        parts = [_value(part) for part in (color or "").split()]
        if len(parts) not in (3, 4) or any(part is None or not isfinite(part) for part in parts):
            parts = [0.7, 0.7, 0.7, 1.0] if transparency > 0 and visual.find("geometry/mesh") is None else []
        if parts:
            values = [min(max(part or 0.0, 0.0), 1.0) for part in parts] + [1.0] * (4 - len(parts))
            values[3] *= 1 - min(max(transparency, 0.0), 1.0)
            diffuse = etree.SubElement(etree.SubElement(visual, "material"), "diffuse")
            diffuse.text = " ".join(f"{value:g}" for value in values)
    yield from ()


def _friction(model: etree._Element) -> Iterator[str]:
    for collision in model.iter("collision"):
        mus = [
            value
            for path in ("surface/friction/ode/mu", "surface/friction/ode/mu2", "surface/friction/bullet/friction")
            if (value := _number(collision.find(path))) is not None and value >= 0
        ]
        for surface in collision.findall("surface"):
            collision.remove(surface)
        friction = min(mus, default=1.0)
        properties = etree.SubElement(
            collision, f"{{{_DRAKE_NAMESPACE}}}proximity_properties", nsmap={"drake": _DRAKE_NAMESPACE}
        )
        for name in ("mu_dynamic", "mu_static"):
            etree.SubElement(properties, f"{{{_DRAKE_NAMESPACE}}}{name}").text = f"{friction:.17g}"
    yield from ()


def _flatten_planes(model: etree._Element) -> None:
    """A plane is drawn as a thin box of its size, whose upper side it is."""
    for plane in [*model.iterfind(".//visual/geometry/plane")]:
        geometry = plane.getparent()
        assert geometry is not None
        visual = geometry.getparent()
        assert visual is not None
        sides = plane_size(plane)
        geometry.remove(plane)
        box = etree.SubElement(etree.SubElement(geometry, "box"), "size")
        box.text = f"{sides[0]:g} {sides[1]:g} {_THIN:g}"
        move_shape(visual, turned_to(plane_normal(plane)), np.array([0.0, 0.0, -_THIN / 2]))


_THIN = 1e-3  # m


def plane_size(plane: etree._Element) -> tuple[float, float]:
    """The sides of a ``<plane>`` (m); what has none, or absurd ones, is 100 m wide."""
    parts = [_value(part) for part in (plane.findtext("size") or "1 1").split()]
    sides = [side if side is not None and 0 < side < 1e4 else 100.0 for side in parts]
    return sides[0], sides[-1]


def plane_normal(plane: etree._Element) -> np.ndarray:
    """The direction that a ``<plane>`` faces, in its shape's frame."""
    parts = [_value(part) for part in (plane.findtext("normal") or "0 0 1").split()]
    normal = np.array([part if part is not None and isfinite(part) else 0.0 for part in parts])
    return normal if normal.shape == (3,) and np.linalg.norm(normal) > 1e-8 else np.array([0.0, 0.0, 1.0])


def turned_to(normal: np.ndarray) -> np.ndarray:
    """A rotation matrix that turns z to a direction."""
    from pydrake.math import RotationMatrix

    if normal[2] > 0 and not np.any(normal[:2]):
        return np.eye(3)
    return np.asarray(RotationMatrix.MakeFromOneVector(normal, 2).matrix())


def move_shape(shape: etree._Element, rotation: np.ndarray, translation: np.ndarray) -> None:
    """Turns a visual or collision about its own frame, then moves it along the turned axes (m)."""
    from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

    pose = shape.find("pose")
    if pose is None:
        pose = etree.SubElement(shape, "pose")
        pose.text = "0 0 0 0 0 0"
    X = pose_transform(pose) @ RigidTransform(RotationMatrix(rotation), rotation @ translation)
    for attribute in ("degrees", "rotation_format"):
        pose.attrib.pop(attribute, "")
    numbers = [*X.translation(), *RollPitchYaw(X.rotation()).vector()]
    pose.text = " ".join(f"{float(number):.17g}" for number in numbers)


def _meshes(model: etree._Element, reader: XmlReader, find: FindFile) -> Iterator[str]:
    """Gives each mesh a form that Drake reads; a static model's collision meshes stay files for the plant to divide."""
    for shape in [*model.iter("collision", "visual")]:
        mesh = shape.find("geometry/mesh")
        link = shape.getparent()
        if mesh is None or link is None:
            continue
        for extra in [child for child in mesh if child.tag not in ("uri", "scale")]:
            mesh.remove(extra)
            if extra.tag == "submesh":
                yield "a <submesh> is not used: the whole mesh is"
        uri = mesh.find("uri")
        address = (mesh.findtext("uri") or "").strip()
        scale = _scale(mesh)
        try:
            if uri is None or scale is None:
                raise InputError(f"it has no {'address' if uri is None else 'scale that is above zero'}")
            file = find(address, reader.file)
            if shape.tag == "visual":
                uri.text = mesh_address(visual_mesh(file))
            elif _within_static(shape):
                uri.text = str(file)
            else:
                _give_hull(shape, mesh, file, scale)
        except MissingPackageError:
            link.remove(shape)  # told once for all its shapes
        except InputError as error:
            link.remove(shape)
            yield f"a {shape.tag} goes without its mesh {address}: {str(error).rstrip('.')}"


def _give_hull(shape: etree._Element, mesh: etree._Element, file: Path, scale: tuple[float, float, float]) -> None:
    """The primitive that a mesh is, or its convex hull."""
    primitive = mesh_primitive(file, scale)
    if primitive is None:
        uri = mesh.find("uri")
        assert uri is not None
        uri.text = mesh_address(collision_mesh(file))
        etree.SubElement(mesh, f"{{{_DRAKE_NAMESPACE}}}declare_convex", nsmap={"drake": _DRAKE_NAMESPACE})
        return
    geometry = mesh.getparent()
    assert geometry is not None
    geometry.remove(mesh)
    kind = etree.SubElement(geometry, primitive.kind)
    if primitive.kind == "box":
        etree.SubElement(kind, "size").text = " ".join(f"{side:.17g}" for side in primitive.size)
    else:
        for tag, value in zip(_SIZES[primitive.kind], primitive.size, strict=True):
            etree.SubElement(kind, tag).text = f"{value:.17g}"
    axis = np.eye(3)[primitive.axis]
    rotation = turned_to(axis) if primitive.kind == "cylinder" else np.eye(3)
    move_shape(shape, rotation, rotation.T @ np.array(primitive.center))


def _scale(mesh: etree._Element) -> tuple[float, float, float] | None:
    parts = [_value(part) for part in (mesh.findtext("scale") or "1 1 1").split()]
    values = [part for part in parts if part is not None and isfinite(part) and abs(part) > 1e-8]
    return (values[0], values[1], values[2]) if len(parts) == len(values) == 3 else None


def _number(element: etree._Element | None) -> float | None:
    return None if element is None else _value((element.text or "").strip())


def _value(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
