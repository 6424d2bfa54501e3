"""The twin's plant and scene graph with the same servos, without any other system in the diagram."""

from pathlib import Path
from typing import ClassVar

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.analysis import Simulator

from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.robots import centers, prepare
from drake_twin.benchmarks.workloads import Workload
from drake_twin.diagram.servo_gains import HOLD, VELOCITY, set_gains


class BarePlant:
    """A plant with the twin's settings, commanded through its ports."""

    sampled_output_ports: ClassVar[bool] = False

    def __init__(self, workload: Workload, count: int, folder: Path, setting: Setting):
        prepared = prepare(workload, count, folder, setting.step, sampled_output_ports=self.sampled_output_ports)
        self._robots = prepared.robots
        self._plant: MultibodyPlant = prepared.parts.plant
        self._positions = prepared.positions
        self._loose = prepared.loose
        self._simulator = Simulator(prepared.builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())
        for robot in self._robots:
            commanded = {robot.in_plant.layout.efforts[joint.name] for joint in robot.joints}
            gains = robot.in_plant.gains
            modes = [VELOCITY if index in commanded else HOLD for index in range(len(gains))]
            set_gains(self._plant, robot.in_plant.instance, gains, modes)

    def command(self, velocities: np.ndarray) -> None:
        """Command joint velocities."""
        for robot, values in zip(self._robots, velocities.tolist(), strict=True):
            layout = robot.in_plant.layout
            desired = np.zeros(2 * layout.num_actuators)
            for joint, value in zip(robot.joints, values, strict=True):
                desired[layout.num_actuators + layout.efforts[joint.name]] = value
            self._plant.get_desired_state_input_port(robot.in_plant.instance).FixValue(self._context, desired)

    def advance_to(self, time: float) -> None:
        """Advance to a time (s)."""
        self._simulator.AdvanceTo(time)

    def positions(self) -> np.ndarray:
        """Return the positions of the commanded joints."""
        return np.asarray(self._plant.GetPositionsAndVelocities(self._context)[self._positions])

    def centers(self) -> np.ndarray:
        """Return the positions of the loose boxes' centers."""
        return centers(self._plant, self._context, self._loose)


class SampledBarePlant(BarePlant):
    """The same plant with sampled output ports, which are Drake's default."""

    sampled_output_ports = True
