"""Services by what they belong to: the twin, a robot, or a node with parameters."""

import importlib
import pkgutil
from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar

from drake_twin.twin.twin import Twin

Fields = Mapping[str, Any]  # of a response
Later = Generator[Any, None, Fields]  # a response that takes several frames: it is continued once a frame
SIMULATION_NODE = "/drake_twin"

_Answer = TypeVar("_Answer", bound=Callable[..., Fields | Later])


@dataclass(frozen=True)
class Service:
    """A service of a running twin.

    Attributes:
        name: Its full name.
        type: Its ROS type.
        node: The full name of its node.
        answer: Takes the request and returns the response's fields, or a generator that does so later; called in the
            simulation's thread.
        between_advances: Whether it does what a callback cannot do, such as a spawn.
    """

    name: str
    type: str
    node: str
    answer: Callable[[Any], Fields | Later]
    between_advances: bool = False


@dataclass(frozen=True)
class _Kind:
    name: str
    type: str
    node: str
    answer: Callable[..., Fields | Later]
    between_advances: bool


_OF_TWIN: list[_Kind] = []
_OF_ROBOT: list[_Kind] = []


def twin_service(
    type: str, name: str, node: str = SIMULATION_NODE, *, between_advances: bool = False
) -> Callable[[_Answer], _Answer]:
    """Decorate a function that answers a service of the twin; it takes the twin and the request.

    Args:
        type: The ROS type.
        name: The full name.
        node: The full name of its node.
        between_advances: Whether it does what a callback cannot do.
    """

    def register(answer: _Answer) -> _Answer:
        _OF_TWIN.append(_Kind(name, type, node, answer, between_advances))
        return answer

    return register


def robot_service(type: str, name: str, node: str) -> Callable[[_Answer], _Answer]:
    """Decorate a function that answers a service of each robot; it takes the twin, the robot and the request.

    Args:
        type: The ROS type.
        name: The name below the node's.
        node: The node's name below the robot's namespace.
    """

    def register(answer: _Answer) -> _Answer:
        _OF_ROBOT.append(_Kind(f"{node}/{name}", type, node, answer, False))
        return answer

    return register


def services_of(twin: Twin) -> tuple[Service, ...]:
    """Return the services of a twin with its present robots and controllers; of two with one name, the first."""
    _import_own()
    found: dict[str, Service] = {}
    for service in _all(twin):
        found.setdefault(service.name, service)
    return tuple(found.values())


def _all(twin: Twin) -> Iterator[Service]:
    from drake_twin.services.entities import world_name
    from drake_twin.services.parameters import parameter_services

    world = world_name(twin)
    for kind in _OF_TWIN:
        yield Service(kind.name.format(world=world), kind.type, kind.node, _for_twin(kind, twin), kind.between_advances)
    for plan in twin.plans:
        namespace = plan.robot.topic_namespace
        for kind in _OF_ROBOT:
            names = f"{namespace}/{kind.name}", kind.type, f"{namespace}/{kind.node}"
            yield Service(*names, _for_robot(kind, twin, plan.name))
    yield from parameter_services(twin)


def _for_twin(kind: _Kind, twin: Twin) -> Callable[[Any], Fields | Later]:
    return lambda request: kind.answer(twin, request)


def _for_robot(kind: _Kind, twin: Twin, robot: str) -> Callable[[Any], Fields | Later]:
    return lambda request: kind.answer(twin, robot, request)


@cache
def _import_own() -> None:
    import drake_twin.services as own

    for module in pkgutil.iter_modules(own.__path__):
        importlib.import_module(f"{own.__name__}.{module.name}")
