"""The services that a running twin offers: its own, its robots', and those of its nodes' parameters."""

from collections.abc import Callable, Iterator
from typing import Any

from drake_twin.services.entities import world_name
from drake_twin.services.parameters import parameter_services
from drake_twin.services.registry import OF_ROBOT, OF_TWIN, Fields, Kind, Later, Service
from drake_twin.twin.twin import Twin


def services_of(twin: Twin) -> tuple[Service, ...]:
    """Return the services of a twin with its present robots and controllers; of two with one name, the first."""
    found: dict[str, Service] = {}
    for service in _all(twin):
        found.setdefault(service.name, service)
    return tuple(found.values())


def _all(twin: Twin) -> Iterator[Service]:
    world = world_name(twin)
    for kind in OF_TWIN.values():
        yield Service(kind.name.format(world=world), kind.type, kind.node, _for_twin(kind, twin), kind.between_advances)
    for plan in twin.built.plans:
        namespace = plan.robot.topic_namespace
        for kind in OF_ROBOT.values():
            names = f"{namespace}/{kind.name}", kind.type, f"{namespace}/{kind.node}"
            yield Service(*names, _for_robot(kind, twin, plan.name))
    yield from parameter_services(twin)


def _for_twin(kind: Kind, twin: Twin) -> Callable[[Any], Fields | Later]:
    return lambda request: kind.answer(twin, request)


def _for_robot(kind: Kind, twin: Twin, robot: str) -> Callable[[Any], Fields | Later]:
    return lambda request: kind.answer(twin, robot, request)
