"""The speeds of surfaces as Drake's plant takes them."""

from collections.abc import Sequence

from pydrake.common.value import AbstractValue, Value
from pydrake.systems.framework import BusValue, Context

from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem


class SurfaceSpeeds(WitnesslessSystem):
    """Name the speeds of surfaces; Drake computes it once for each change of a speed.

    .. pydrake_system::

        name: SurfaceSpeeds
        input_ports:
        - surface_speeds_0
        - surface_speeds_1
        - …
        output_ports:
        - surface_speeds

    - ``surface_speeds_0``, …: the speeds of a controller's surfaces (m/s).
    - ``surface_speeds``: a ``BusValue`` with the speed of each body under its scoped name, for the plant's port.

    Args:
        names: For each input port the scoped names of its bodies.
    """

    def __init__(self, names: Sequence[Sequence[str]]):
        super().__init__()
        self._inputs = [
            (own, self.DeclareVectorInputPort(f"surface_speeds_{number}", len(own))) for number, own in enumerate(names)
        ]
        self.DeclareAbstractOutputPort(
            "surface_speeds", lambda: Value(BusValue()), weakly(self._calc), {self.all_input_ports_ticket()}
        )

    def _calc(self, context: Context, output: AbstractValue) -> None:
        bus = BusValue()
        for names, port in self._inputs:
            for name, speed in zip(names, port.Eval(context).tolist(), strict=True):
                bus.Set(name, Value(speed))
        output.set_value(bus)
