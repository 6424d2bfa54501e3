"""The past states that robots with a measurement delay read: their start, and what snapshots and rebuilds keep."""

from collections.abc import Mapping
from math import ceil
from typing import Any

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.diagram.twin_diagram import TwinDiagram

Past = tuple[np.ndarray, ...]

_STATE = "state"


class LateMeasurements:
    """The delays of a diagram; empty without robots that have one.

    Args:
        built: The diagram.
        context: Its root context.

    Attributes:
        contexts: Those of the systems that keep the past.
    """

    def __init__(self, built: TwinDiagram, context: Context):
        self._delays = {
            robot: {name: (item, item.GetMyMutableContextFromRoot(context)) for name, item in parts.delays.items()}
            for robot, parts in built.parts.items()
            if parts.delays
        }
        self.contexts = [context for delays in self._delays.values() for _, context in delays.values()]

    def start(self) -> None:
        """Set the past to the present state, at rest without efforts."""
        for delays in self._delays.values():
            for name, (system, context) in delays.items():
                port = system.get_input_port()
                present = port.Eval(context) if name == _STATE else np.zeros(port.size())
                context.SetDiscreteState(np.tile(present, context.num_total_states() // port.size()))

    def past(self) -> Past:
        """Return the past, for `go_back`."""
        return tuple(context.get_discrete_state_vector().CopyToVector() for context in self.contexts)

    def go_back(self, past: Past) -> None:
        """Set what `past` returned."""
        for context, values in zip(self.contexts, past, strict=True):
            context.SetDiscreteState(values)

    def state(self, robot: str) -> dict[str, Any]:
        """Return the entries of a robot in a snapshot: for each delay the values of the past steps, oldest first."""
        delays = self._delays.get(robot)
        if delays is None:
            return {}
        vectors = {name: context.get_discrete_state_vector().CopyToVector() for name, (_, context) in delays.items()}
        return {"measured": {name: vector.tolist() for name, vector in vectors.items()}}

    def set_state(self, robot: str, entries: Mapping[str, Any], step_ratio: float = 1.0) -> None:
        """Set the entries that `state` returned.

        Args:
            robot: The robot's name.
            entries: Its entries in a snapshot.
            step_ratio: The physics step of this diagram over that of the snapshot's.

        Raises:
            ValueError: If they are those of another robot.
        """
        delays, saved = self._delays.get(robot, {}), entries.get("measured", {})
        if set(delays) != set(saved):
            raise ValueError("the measured values are those of another robot")
        for name, (system, context) in delays.items():
            size = system.get_input_port().size()
            before = np.array(saved[name], dtype=float).reshape(-1, size)
            ages = np.arange(context.num_total_states() // size, 0, -1) * step_ratio
            if step_ratio == 1.0 and len(before) != len(ages):
                raise ValueError(f"{len(ages)} measured values are needed, not {len(before)}")
            steps = [min(ceil(age - 1e-6), len(before)) for age in ages]
            context.SetDiscreteState(before[[len(before) - step for step in steps]].ravel())
