"""The pushes of a scenario as forces on links."""

from collections import Counter
from collections.abc import Collection
from dataclasses import replace
from hashlib import blake2b
from math import cos, pi, sin

from drake_twin.description.robot_description import Vector3
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import InputError
from drake_twin.scenario import Push, Scenario, ScenarioError
from drake_twin.twin.entity_state import find_body


def settled_pushes(built: TwinDiagram, scenario: Scenario) -> tuple[Push, ...]:
    """Return the pushes of a scenario with the full names of their links, their points and forces.

    Args:
        built: The diagram.
        scenario: The scenario.

    Raises:
        ScenarioError: If the robot, model or link of one does not exist.
    """
    found: list[Push] = []
    before: Counter[str] = Counter()  # pushes of an entity
    for index, push in enumerate(scenario.pushes):
        entity = _full_name(built, push.entity)
        try:
            body = find_body(built, entity)
        except InputError as error:
            raise ScenarioError(("pushes", index), error.message, value=error.value, valid=error.valid) from None
        number, before[entity] = before[entity], before[entity] + 1
        force = push.force
        if force is None:
            assert push.strength is not None, "a push has one of the two"
            force = _drawn(push.strength, f"{scenario.seed}\0push\0{entity}\0{number}")
        x, y, z = map(float, body.default_com())
        found.append(replace(push, entity=entity, force=force, strength=None, at=push.at or (x, y, z)))
    return tuple(found)


def _full_name(built: TwinDiagram, entity: str) -> str:
    robot, separator, link = entity.partition("::")
    links: Collection[str] = next((plan.description.links for plan in built.plans if plan.name == robot), ())
    is_short = separator and link not in links and f"{robot}_{link}" in links
    return f"{robot}::{robot}_{link}" if is_short else entity


def _drawn(strength: float, key: str) -> Vector3:
    """Return a horizontal force in a direction that follows from a text, each direction as likely as another."""
    number = int.from_bytes(blake2b(key.encode(), digest_size=8).digest(), "little")
    angle = 2.0 * pi * number / 2**64
    return strength * cos(angle), strength * sin(angle), 0.0
