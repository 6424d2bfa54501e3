"""The pairs of shapes that meet, and the role of each shape in a pair.

Drake stores two properties per shape that depend on its partner: whether it yields, and its friction. So a shape is
registered once for each kind of partner that needs another value, and collision filters let each pair of shapes meet
exactly once:

- *Yielding.* Of two shapes one has to yield. Static shapes do to tracks alone (``hard_tracks``). Of two moving shapes
  the lighter one yields and the heavier one is hard: if both yield alike, the pressure acts on the tilted rim of the
  patch, which brakes a slide by 16 % too much at 3 m/s. Two robots with joints both yield: doubled shapes would cost
  time in every step, and robots rarely slide on one another.
- *Friction.* Gazebo uses the smaller coefficient of two shapes, Drake 2·a·b/(a + b). A shape is registered at its own
  level of friction and at the levels of the smoother shapes that it meets: at each level both partners have the same
  coefficient. Of hundreds of static shapes each is registered once; for them, moving shapes are registered with the
  coefficient whose combination with theirs is the smaller one.
"""

from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import combinations_with_replacement
from typing import NamedTuple

from pydrake.geometry import CollisionFilterDeclaration, GeometryId, GeometrySet, HalfSpace, RoleAssign, SceneGraph
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody

from drake_twin.dataclass import dataclass
from drake_twin.description.drake_log import captured_warnings
from drake_twin.diagram.contact_material import candidates
from drake_twin.diagram.contact_models import ContactModel
from drake_twin.diagram.contact_shapes import ContactShape, Group, Part, has_short_steps
from drake_twin.diagram.yielding_shapes import hard, yielding
from drake_twin.errors import InputError

# The role of a shape towards a partner: rigid because it is static, yielding, rigid because the partner yields, or with
# point contact.
STATIC, SOFT, HARD, POINTED = "static", "soft", "hard", "pointed"

# The roles of tracks and of static shapes towards each other (``hard_tracks``).
BELT, GROUND = "belt", "ground"


# Above this number of static shapes each is registered once (a plant takes time and memory with the square of their
# number).
_MOST_STATIC = 100
_MOST_PLANES = 12  # Drake 1.51 crashes with more than 14 half spaces
_NOTICEABLE = 1e-3  # of a coefficient of friction
_ONE_FOR_ALL = -1.0  # the level of such shapes

# The coefficient that the ground is registered with where its friction may change: with a ground rougher than all
# shapes each of them meets it at the shape's own level, where the ground's coefficient then decides (see `towards`).
ROUGH = 1e9


@dataclass(frozen=True)
class Variant:
    """A shape as some of its partners meet it.

    Attributes:
        level: The coefficient of friction that two shapes share so that they can meet, or `_ONE_FOR_ALL`.
        role: `STATIC`, `SOFT`, `HARD`, `POINTED`, `BELT` or `GROUND`.
        friction: The coefficient of friction.
    """

    level: float
    role: str
    friction: float


class _Class(NamedTuple):
    """What decides on the variants of a shape."""

    group: Group | None
    is_static: bool
    friction: float
    role: str
    is_loose: bool
    part: Part
    is_track: bool
    is_plane: bool


def usual_role(shape: ContactShape) -> str:
    """Return the role of a shape towards most partners."""
    if not shape.is_flat:
        return POINTED
    return STATIC if shape.is_static else SOFT


def variants(shapes: Sequence[ContactShape], warnings: list[str]) -> list[list[Variant]]:
    """Return the variants in which each shape meets others, its usual one first if it has that.

    Args:
        shapes: All shapes.
        warnings: Is extended by the pairs whose friction is not the smaller one.
    """
    static = Counter(shape.friction for shape in shapes if shape.is_static)
    planes = sum(isinstance(shape.shape, HalfSpace) for shape in shapes) * len({shape.friction for shape in shapes})
    too_many = static.total() > _MOST_STATIC or planes > _MOST_PLANES
    common = static.most_common(1)[0][0] if too_many else None
    if too_many and ROUGH in static:
        what = f"the ground's friction cannot be varied beside more than {_MOST_STATIC} shapes or several planes"
        raise InputError(f"{what}: set world.ground_friction")
    classes = [
        _Class(
            shape.group,
            shape.is_static,
            shape.friction,
            usual_role(shape),
            shape.is_loose,
            shape.part,
            shape.is_track,
            isinstance(shape.shape, HalfSpace),
        )
        for shape in shapes
    ]
    keys = list(dict.fromkeys(classes))
    wanted: list[set[Variant]] = [set() for _ in keys]
    for (number, one), (partner, other) in combinations_with_replacement(enumerate(keys), 2):
        if not _meet(one, other):
            continue
        if common is not None and (one.is_static or other.is_static):
            for index, key in ((number, one), (partner, other)):
                friction = key.friction if key.is_static else towards(common, key.friction)
                wanted[index].add(Variant(_ONE_FOR_ALL, key.role, friction))
            continue
        roles = one.role, other.role
        if roles == (SOFT, SOFT) and (one.is_loose or other.is_loose):
            assert one.group is not None
            assert other.group is not None
            roles = (SOFT, HARD) if one.group < other.group else (HARD, SOFT)
        elif set(roles) == {SOFT, STATIC} and (one.is_track or other.is_track) and not (one.is_plane or other.is_plane):
            roles = (BELT, GROUND) if one.is_track else (GROUND, BELT)
        level = min(one.friction, other.friction)
        wanted[number].add(Variant(level, roles[0], level))
        wanted[partner].add(Variant(level, roles[1], level))
    needs = dict(zip(keys, wanted, strict=True))
    if common is not None:
        moving_ones = {shape.friction for shape in shapes if not shape.is_static}
        warnings.extend(_inexact(common, set(static), moving_ones))
    found = []
    for shape, key in zip(shapes, classes, strict=True):
        usual = Variant(shape.friction, usual_role(shape), shape.friction)
        found.append(sorted(needs[key] or {usual}, key=lambda item: (item != usual, item.role, item.level)))
    return found


def towards(partner: float, friction: float) -> float:
    """Return the coefficient whose combination with a partner's in Drake is the smaller of the two."""
    if friction >= partner:
        return partner
    return friction * partner / (2 * partner - friction)


def _inexact(common: float, static: Collection[float], moving: Collection[float]) -> Iterator[str]:
    for partner in sorted(set(static) - {common}):
        for friction in sorted(moving):
            own, wanted = towards(common, friction), min(partner, friction)
            acts = 2 * own * partner / (own + partner) if own + partner > 0 else 0.0
            if abs(acts - wanted) > _NOTICEABLE * wanted:
                what = f"the friction of {friction:g} on shapes of {partner:g} acts as {acts:.3g} instead of {wanted:g}"
                yield f"the world has too many shapes: {what}"


def _meet(one: _Class, other: _Class) -> bool:
    """Return whether shapes of two classes meet.

    Those of one model do if its bodies collide with each other; of balls and what they meet see `Part`.
    """
    if one.is_static and other.is_static:
        return False
    if not one.part.meets(other.part):
        return False
    if one.group is None or other.group is None or one.group.model != other.group.model:
        return True
    return one.group != other.group and min(one.group.body, other.group.body) >= 0


@dataclass(frozen=True)
class _Registered:
    geometry: GeometryId
    shape: ContactShape
    variant: Variant


class Registry:
    """Register shapes in their variants, and let each pair of shapes meet once.

    Args:
        plant: The plant, not yet finalized.
        scene_graph: Its scene graph.
        gradient: How fast the pressure rises in what is `GROUND` (Pa/m).

    Attributes:
        without_faces: The shapes that cannot have the hydroelastic contact that they should have.
    """

    def __init__(self, plant: MultibodyPlant, scene_graph: SceneGraph, gradient: float):
        self._plant = plant
        self._scene_graph = scene_graph
        self._registered: list[_Registered] = []
        self.without_faces: set[GeometryId] = set()
        self._gradient = gradient

    def add(self, shape: ContactShape, wanted: Sequence[Variant]) -> None:
        """Make a shape's geometry, if it has one, the first variant, and register the others beside it."""
        source = self._plant.get_source_id()
        for number, variant in enumerate(wanted):
            soft, is_rigid = yielding(shape) if variant.role == SOFT else None, variant.role in (STATIC, HARD, BELT)
            if variant.role in (BELT, GROUND):
                from drake_twin.diagram.hard_tracks import hard_track, yielding_ground

                soft = yielding_ground(shape) if variant.role == GROUND else None
            form = shape.shape if soft is None else soft.shape
            if variant.role == HARD and not shape.is_loose:
                form = hard(shape, is_fine=not has_short_steps(self._plant))
            form = hard_track(shape) if variant.role == BELT else form
            geometry, has_faces = shape.geometry if number == 0 else None, False
            if geometry is not None:
                self._scene_graph.ChangeShape(source, geometry, form, shape.X_BG)
            possible = candidates(
                shape,
                variant.friction,
                soft=soft,
                is_rigid=is_rigid,
                is_discrete=self._plant.time_step() > 0,
                gradient=self._gradient if variant.role == GROUND else None,
            )
            for has_faces, properties in possible:  # noqa: B007
                # Drake warns that deformable bodies would pass through a half space; the twin has none.
                with suppress(RuntimeError), captured_warnings():
                    if geometry is not None:
                        self._scene_graph.AssignRole(source, geometry, properties, RoleAssign.kReplace)
                    else:
                        name = f"{shape.name}|{number}" if number else shape.name
                        geometry = self._plant.RegisterCollisionGeometry(shape.body, shape.X_BG, form, name, properties)
                    break
            assert geometry is not None
            if shape.is_flat and not has_faces:
                self.without_faces.add(shape.geometry or geometry)
            self._registered.append(_Registered(geometry, shape, variant))

    def filter(self) -> None:
        """Let each pair of shapes meet at the smoother one's level, with the lighter one yielding."""
        levels: dict[float, list[_Registered]] = defaultdict(list)
        roles: dict[str, list[_Registered]] = defaultdict(list)
        soft: dict[Group, list[_Registered]] = defaultdict(list)
        hard: dict[Group, list[_Registered]] = defaultdict(list)
        for item in self._registered:
            levels[item.variant.level].append(item)
            roles[item.variant.role].append(item)
            if item.variant.role in (SOFT, HARD):
                assert item.shape.group is not None
                (soft if item.variant.role == SOFT else hard)[item.shape.group].append(item)
        ascending = sorted(levels)
        for index, level in enumerate(ascending):
            self._exclude_between(levels[level], [item for above in ascending[index + 1 :] for item in levels[above]])
            # Shapes that are rougher than the level are registered there for those whose level it is.
            self._exclude_within(
                item
                for item in levels[level]
                if (not item.shape.is_static if level == _ONE_FOR_ALL else item.shape.friction > level)
            )
        parts: dict[Part, list[_Registered]] = defaultdict(list)
        for item in self._registered:
            parts[item.shape.part].append(item)
        for one, other in combinations_with_replacement(parts, 2):
            if one.meets(other):
                continue
            if one is other:
                self._exclude_within(parts[one])
            else:
                self._exclude_between(parts[one], parts[other])
        self._exclude_within(roles[HARD])
        loose = [item for item in roles[SOFT] if item.shape.is_loose]
        self._exclude_within(loose)
        self._exclude_between(loose, [item for item in roles[SOFT] if not item.shape.is_loose])
        self._exclude_between(roles[HARD], [*roles[STATIC], *roles[POINTED]])
        self._exclude_within([*roles[BELT]])
        others = [item for role, items in roles.items() if role not in (BELT, GROUND) for item in items]
        self._exclude_between([*roles[BELT], *roles[GROUND]], others)
        self._exclude_between(
            [item for item in roles[SOFT] if item.shape.is_track and roles[BELT]],
            [item for item in roles[STATIC] if not isinstance(item.shape.shape, HalfSpace)],
        )
        groups = sorted({*soft, *hard})
        for index, group in enumerate(groups):
            self._exclude_between(hard[group], [item for heavier in groups[index:] for item in soft[heavier]])

    def _exclude_within(self, items: Iterable[_Registered]) -> None:
        geometries = [item.geometry for item in items]
        if len(geometries) > 1:
            self._apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet(geometries)))

    def _exclude_between(self, some: Iterable[_Registered], others: Iterable[_Registered]) -> None:
        one, other = [item.geometry for item in some], [item.geometry for item in others]
        if one and other:
            self._apply(CollisionFilterDeclaration().ExcludeBetween(GeometrySet(one), GeometrySet(other)))

    def _apply(self, declaration: CollisionFilterDeclaration) -> None:
        self._scene_graph.collision_filter_manager().Apply(declaration)


def exclude_within_models(plant: MultibodyPlant, scene_graph: SceneGraph, models: Sequence[ContactModel]) -> None:
    """Let links of one model pass through each other, as in Gazebo, except those declared to collide.

    Nothing collides between two links with a joint. Where Gazebo folds links on fixed joints into one, nor does what
    is fixed to the two.
    """
    manager = scene_graph.collision_filter_manager()
    for model in models:
        bodies = [plant.get_body(index) for instance in model.instances for index in plant.GetBodyIndices(instance)]
        if model.folded:
            for parents, children in _jointed(plant, model):
                manager.Apply(CollisionFilterDeclaration().ExcludeBetween(parents, children))
        for body in bodies:  # Drake filters these, but forgets it where it changes a shape
            own = plant.GetCollisionGeometriesForBody(body)
            if len(own) > 1 and (model.colliding is None or body.name() in model.colliding):
                manager.Apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet(own)))
        if model.colliding is None:
            continue
        apart = plant.CollectRegisteredGeometries([body for body in bodies if body.name() in model.colliding])
        others = plant.CollectRegisteredGeometries([body for body in bodies if body.name() not in model.colliding])
        manager.Apply(CollisionFilterDeclaration().ExcludeWithin(others).ExcludeBetween(others, apart))


def _jointed(plant: MultibodyPlant, model: ContactModel) -> Iterator[tuple[GeometrySet, GeometrySet]]:
    """Yield the shapes on the two sides of each joint that moves, with those of all links that are folded into them."""

    def link(body: RigidBody) -> str:
        return model.folded.get(body.name(), body.name())

    families: defaultdict[str, list[RigidBody]] = defaultdict(list)
    for index in (index for instance in model.instances for index in plant.GetBodyIndices(instance)):
        families[link(plant.get_body(index))].append(plant.get_body(index))
    for joint in map(plant.get_joint, plant.GetJointIndices()):
        if joint.model_instance() in model.instances and joint.num_velocities():
            sides = (families[link(body)] for body in (joint.parent_body(), joint.child_body()))
            parents, children = map(plant.CollectRegisteredGeometries, sides)
            yield parents, children
