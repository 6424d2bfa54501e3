"""The state of the systems that a user has added to the diagram."""

from collections.abc import Mapping
from typing import Any

from pydrake.systems.framework import Context, System

from drake_twin.diagram.twin_diagram import TwinDiagram


class ExtensionState:
    """The continuous and discrete state of a user's own systems, by their names.

    Args:
        built: The diagram.
        context: Its root context.
    """

    def __init__(self, built: TwinDiagram, context: Context):
        self._systems: list[tuple[System, Context]] = [
            (system, system.GetMyMutableContextFromRoot(context)) for system in built.extensions
        ]

    def state(self) -> dict[str, list[list[float]]]:
        """Return each system's state vectors; a system without any is left out.

        Abstract state cannot be saved as plain data and is left out, too.
        """
        found = {}
        for system, context in self._systems:
            vectors = [context.get_continuous_state_vector().CopyToVector().tolist()]
            groups = range(context.num_discrete_state_groups())
            vectors += [context.get_discrete_state(index).value().tolist() for index in groups]
            if any(vectors):
                found[system.get_name()] = vectors
        return found

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set what `state` returned; a system that is not in it keeps its state.

        Raises:
            ValueError: If a system is unknown, or a vector has another size.
        """
        if unknown := state.keys() - {system.get_name() for system, _ in self._systems}:
            raise ValueError(f"the diagram has no systems {', '.join(sorted(unknown))}")
        for system, context in self._systems:
            vectors = state.get(system.get_name())
            if vectors is None:
                continue
            continuous, *groups = vectors
            if len(groups) != context.num_discrete_state_groups():
                raise ValueError(f"system {system.get_name()!r} has {context.num_discrete_state_groups()} state groups")
            if continuous:
                context.SetContinuousState(continuous)
            for index, values in enumerate(groups):
                context.SetDiscreteState(index, values)
