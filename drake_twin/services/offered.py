"""The services that a running twin offers: its own, its robots', and those of its nodes' parameters."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from drake_twin.services.entities import world_name
from drake_twin.services.others_answer import others_answer
from drake_twin.services.parameters import parameter_services
from drake_twin.services.registry import OF_ROBOT, OF_TWIN, Service
from drake_twin.twin.twin import Twin


def services_of(twin: Twin) -> tuple[Service, ...]:
    """Return the services of a twin with its present robots and controllers; of two with one name, the first."""
    found: dict[str, Service] = {}
    for service in _all(twin):
        found.setdefault(service.name, service)
    nodes = {*(item.node for item in found.values()), *(item.node for item in twin.graph.endpoints)}
    for service in parameter_services(twin, nodes):
        found.setdefault(service.name, service)
    return tuple(found.values())


def _all(twin: Twin) -> Iterator[Service]:
    world = world_name(twin)
    for name, each in OF_TWIN.items():
        answer = others_answer(twin, each) if OF_TWIN.is_of_others(name) else each.answer
        yield replace(each, name=each.name.format(world=world), answer=partial(answer, twin))
    for plan in twin.built.plans:
        namespace = plan.robot.topic_namespace
        for key, each in OF_ROBOT.items():
            answer = others_answer(twin, each) if OF_ROBOT.is_of_others(key) else each.answer
            name, node = f"{namespace}/{each.name}", f"{namespace}/{each.node}"
            yield replace(each, name=name, node=node, answer=partial(answer, twin, plan.name))
