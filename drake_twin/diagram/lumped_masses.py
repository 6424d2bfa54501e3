"""Light links on fixed joints, whose mass CENIC takes for that of all that moves with them.

CENIC lets a sticking contact slip in proportion to its force, the step and 1 / mass of the link that touches. Feet of
1 mg on fixed joints, as robots with legs have, slide as on ice: HyQ at 0.1 m/s under a push of 10 N. A link without a
mass counts as all links that it is fixed to. So light links that collide give their inertia to the heaviest one of
these. Gazebo does so with all links on fixed joints; what moves is the same.
"""

from collections.abc import Iterator, Mapping

import numpy as np
from lxml import etree
from pydrake.math import RigidTransform, RollPitchYaw

from drake_twin.dataclass import dataclass

# A link is light if it has less than this part of the mass of the links that it is fixed to, itself included.
_LIGHT = 0.5


@dataclass(frozen=True)
class _Inertia:
    """A link's mass (kg), center of mass (m) and moments of inertia about it (kg·m²), in the axes of one link."""

    mass: float
    center: np.ndarray
    moments: np.ndarray

    def seen_from(self, X: RigidTransform) -> "_Inertia":
        """Return it in the axes of another link, in which this one has the pose X."""
        R = X.rotation().matrix()
        return _Inertia(self.mass, X @ self.center, R @ self.moments @ R.T)

    def __add__(self, other: "_Inertia") -> "_Inertia":
        mass = self.mass + other.mass
        center = (self.mass * self.center + other.mass * other.center) / mass
        moments = np.zeros((3, 3))
        for part in (self, other):
            lever = part.center - center
            moments += part.moments + part.mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
        return _Inertia(mass, center, moments)


def with_lumped_masses(urdf: str) -> str:
    """Return a URDF whose light links with collision shapes have given their inertia to what they are fixed to."""
    root = etree.fromstring(urdf.encode())
    links = {_named(link, "name"): link for link in root.iterfind("link")}
    has_changed = False
    for poses in _fixed_groups(root, links):
        inertias = {name: inertia for name in poses if (inertia := _inertia(links[name])) is not None}
        total = sum(inertia.mass for inertia in inertias.values())
        if not inertias:
            continue
        heaviest = max(inertias, key=lambda name: inertias[name].mass)
        for name, inertia in inertias.items():
            if name == heaviest or inertia.mass >= _LIGHT * total or links[name].find("collision") is None:
                continue
            inertias[heaviest] += inertia.seen_from(poses[heaviest].inverse() @ poses[name])
            links[name].remove(_child(links[name], "inertial"))
            _set_inertia(links[heaviest], inertias[heaviest])
            has_changed = True
    return etree.tostring(root, encoding="unicode") if has_changed else urdf


def gave_its_mass(urdf: str, link: str) -> bool:
    """Return whether a link of a URDF is one of these light links.

    Args:
        urdf: The URDF that `with_lumped_masses` took.
        link: The name of the link's body.
    """
    before, after = (etree.fromstring(text.encode()) for text in (urdf, with_lumped_masses(urdf)))
    before_it, after_it = (root.xpath("boolean(link[@name=$name]/inertial)", name=link) for root in (before, after))
    return bool(before_it and not after_it)


def _fixed_groups(root: etree._Element, links: Mapping[str, etree._Element]) -> Iterator[dict[str, RigidTransform]]:
    """Yield the links of each group on fixed joints, with their poses in the group's first link."""
    children: dict[str, list[tuple[str, RigidTransform]]] = {name: [] for name in links}
    fixed = set()
    for joint in root.iterfind("joint[@type='fixed']"):
        parent, child = (_named(_child(joint, end), "link") for end in ("parent", "child"))
        children[parent].append((child, _pose(joint)))
        fixed.add(child)
    for first in (name for name in links if name not in fixed):
        poses, waiting = {first: RigidTransform()}, [first]
        while waiting:
            link = waiting.pop()
            for child, X in children[link]:
                poses[child] = poses[link] @ X
                waiting.append(child)
        yield poses


def _inertia(link: etree._Element) -> _Inertia | None:
    """Return a link's inertia; None without a mass."""
    inertial, given_mass = link.find("inertial"), link.find("inertial/mass")
    mass = 0.0 if given_mass is None else float(given_mass.get("value", "0"))
    if inertial is None or mass <= 0.0:
        return None
    given = inertial.find("inertia")
    xx, yy, zz, xy, xz, yz = (
        0.0 if given is None else float(given.get(name, "0")) for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    own = _Inertia(mass, np.zeros(3), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    return own.seen_from(_pose(inertial))


def _set_inertia(link: etree._Element, inertia: _Inertia) -> None:
    inertial = _child(link, "inertial")
    inertial.clear()
    etree.SubElement(inertial, "origin", xyz=" ".join(repr(float(value)) for value in inertia.center))
    etree.SubElement(inertial, "mass", value=repr(float(inertia.mass)))
    moments = etree.SubElement(inertial, "inertia")
    for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        moments.set(f"i{'xyz'[row]}{'xyz'[column]}", repr(float(inertia.moments[row, column])))


def _pose(element: etree._Element) -> RigidTransform:
    """Return the pose of a joint or an inertia, its element ``<origin>``."""
    origin = element.find("origin")
    if origin is None:
        return RigidTransform()
    xyz, rpy = ([float(value) for value in origin.get(name, "0 0 0").split()] for name in ("xyz", "rpy"))
    return RigidTransform(RollPitchYaw(*rpy), np.array(xyz))


def _child(element: etree._Element, tag: str) -> etree._Element:
    child = element.find(tag)
    assert child is not None, "the URDF is prepared for Drake"
    return child


def _named(element: etree._Element, attribute: str) -> str:
    value = element.get(attribute)
    assert value is not None, "the URDF is prepared for Drake"
    return value
