"""The numbers of a plant that drafts of messages are made of."""

from functools import cached_property

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.systems.plant_ports import PlantPorts

_CONSTANTS = np.array([np.nan, 0.0])


class Reading:
    """The numbers of a plant at the time of a context, read when asked for, which must be before the context changes.

    Args:
        ports: The plant's ports.
        root_context: The root diagram's context.
        plant_context: The plant's context in it.

    Attributes:
        root_context: The root diagram's context.
        time: Its time (s).
    """

    def __init__(self, ports: PlantPorts, root_context: Context, plant_context: Context):
        self._ports, self._plant = ports, ports.plant
        self._plant_context = plant_context
        self.root_context = root_context
        self.time: float = root_context.get_time()

    @cached_property
    def state(self) -> np.ndarray:
        """The plant's ``[q; v]``, shape (n,)."""
        state: np.ndarray = self._plant.GetPositionsAndVelocities(self._plant_context)
        return state

    @cached_property
    def with_efforts(self) -> np.ndarray:
        """``[q; v]``, the efforts of all actuators (N·m or N), NaN and 0; shape (n + m + 2,)."""
        efforts = self._ports.efforts(self.root_context, self._plant_context)
        return np.concatenate((self.state, efforts, _CONSTANTS))

    @cached_property
    def without_efforts(self) -> np.ndarray:
        """The same with NaN for all efforts: after a command they take as long as a step."""
        return np.concatenate((self.state, np.full(self._plant.num_actuators(), np.nan), _CONSTANTS))
