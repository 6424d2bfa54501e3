"""Losses of a link's kinetic energy, as gz-sim's KineticEnergyMonitor publishes them: how hard something was hit."""

from dataclasses import field
from typing import Any, ClassVar

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.controllers.sensor_reader import SensorReader
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.gazebo_drive import KINETIC_ENERGY_MONITOR
from drake_twin.description.robot_description import RobotDescription
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.sensors.kinetic_energy_sensor import KineticEnergySensor


@dataclass(frozen=True, kw_only=True)
class KineticEnergyMonitorParameters:
    """Parameters of ``gz_sim/KineticEnergyMonitor``, named after those of ``gz-sim-kinetic-energy-monitor-system``.

    Attributes:
        link_name: The link.
        kinetic_energy_threshold: A larger loss between two updates is published (J).
    """

    link_name: str
    kinetic_energy_threshold: float = field(default=7.0)


@saved("KineticEnergy")
@dataclass(frozen=True)
class KineticEnergy(Frozen):
    """What the monitor remembers.

    Attributes:
        energy: The energy at the last update (J).
        loss: How much had been lost since the one before (J), if that was more than the threshold; else zero.
    """

    energy: float = 0.0
    loss: float = 0.0


@controller(KINETIC_ENERGY_MONITOR)
class KineticEnergyMonitor(SensorReader, PeriodicController):
    """Publish how much kinetic energy a link has lost since the last update, if that is more than a threshold.

    Behaves as gz-sim's KineticEnergyMonitor (from its sources), which compares the energies of each two physics steps,
    the first one with zero. The link's mass and inertia are those of its file.

    .. pydrake_system::

        name: KineticEnergyMonitor
        input_ports:
        - energy
        - state
        output_ports:
        - kinetic_energy

    - ``energy``: vector of one element (J), as from `KineticEnergySensor`.
    - ``kinetic_energy``: ``std_msgs/msg/Float64`` of the loss at the last update (J); None without one.
    """

    Parameters: ClassVar[type] = KineticEnergyMonitorParameters
    kind = ""

    @classmethod
    def sensor_name(cls, parameters: Any) -> str:
        """Return an empty name: the robot's file has no such sensor."""
        return ""

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return why nothing can be monitored; None if it can."""
        if parameters.link_name in description.links:
            return None
        return f"the robot has no link {parameters.link_name!r}"

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._energy = self.declare_sensor_input("energy")
        self.declare_message_output("kinetic_energy", "std_msgs/msg/Float64", self._message)

    def num_values(self) -> int:
        """Return the size of the port ``energy``."""
        return 1

    def own_sensor(self, plant: MultibodyPlant, instance: ModelInstanceIndex) -> KineticEnergySensor:
        """Return a sensor of the link's energy."""
        body = plant.GetBodyByName(drake_link_name(self.setup.parameters.link_name), instance)
        return KineticEnergySensor(body.index(), body.default_spatial_inertia())

    def start(self, context: Context) -> KineticEnergy:
        """Return the energy at rest."""
        return KineticEnergy()

    def update(self, context: Context, time: float, memory: KineticEnergy) -> Update:
        """Compare the present energy with the last one."""
        energy = float(self._energy.Eval(context)[0])
        loss = memory.energy - energy
        is_large = loss > self.setup.parameters.kinetic_energy_threshold
        return Update(KineticEnergy(energy, loss if is_large else 0.0), ())

    def _message(self, context: Context) -> Any:
        memory: KineticEnergy | None = self.sample(context).memory
        return messages.Float64(memory.loss) if memory is not None and memory.loss else None
