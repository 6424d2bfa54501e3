"""The contacts of several plants, with the names that bodies and shapes have in one that holds all."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from pydrake.geometry import GeometryId
from pydrake.multibody.plant import ContactResults
from pydrake.multibody.tree import BodyIndex


class Contacts(NamedTuple):
    """The contacts in an island, and what its bodies and shapes are elsewhere."""

    results: ContactResults
    bodies: Mapping[BodyIndex, BodyIndex]
    shapes: Mapping[GeometryId, GeometryId]


class _Renamed:
    """One of Drake's objects, with other answers to some questions."""

    def __init__(self, own: Any, **answers: Any):
        self._own = own
        self.__dict__.update(answers)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._own, name)


class JoinedContacts:
    """The contacts of islands, with those methods of Drake's ContactResults that sensors, page and tests use."""

    def __init__(self, islands: Sequence[Contacts]):
        self._points: list[Any] = []
        self._surfaces: list[Any] = []
        for results, bodies, shapes in islands:
            for info in map(results.point_pair_contact_info, range(results.num_point_pair_contacts())):
                pair = info.point_pair()
                named = _Renamed(pair, id_A=shapes[pair.id_A], id_B=shapes[pair.id_B])
                A, B = bodies[info.bodyA_index()], bodies[info.bodyB_index()]
                point = _Renamed(
                    info,
                    point_pair=lambda named=named: named,
                    bodyA_index=lambda A=A: A,
                    bodyB_index=lambda B=B: B,
                )
                self._points.append(point)
            for face in map(results.hydroelastic_contact_info, range(results.num_hydroelastic_contacts())):
                surface = face.contact_surface()
                M, N = shapes[surface.id_M()], shapes[surface.id_N()]
                renamed = _Renamed(surface, id_M=lambda M=M: M, id_N=lambda N=N: N)
                self._surfaces.append(_Renamed(face, contact_surface=lambda renamed=renamed: renamed))

    def num_point_pair_contacts(self) -> int:
        """Return how many pairs of points touch."""
        return len(self._points)

    def point_pair_contact_info(self, index: int) -> Any:
        """Return one of them, as Drake's PointPairContactInfo."""
        return self._points[index]

    def num_hydroelastic_contacts(self) -> int:
        """Return how many pairs of surfaces touch."""
        return len(self._surfaces)

    def hydroelastic_contact_info(self, index: int) -> Any:
        """Return one of them, as Drake's HydroelasticContactInfo."""
        return self._surfaces[index]
