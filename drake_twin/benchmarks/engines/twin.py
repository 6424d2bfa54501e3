"""The twin, as `drake_twin.Twin` runs it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np
from pydrake.systems.analysis import SimulatorStatus

from drake_twin.benchmarks.engine import Setting
from drake_twin.benchmarks.robots import centers, commanded
from drake_twin.benchmarks.workloads import Workload
from drake_twin.scenario import CENIC, CONTACT_APPROXIMATIONS, DISCRETE
from drake_twin.twin.twin import Twin


class TwinEngine:
    """A twin without subscribers."""

    def __init__(self, workload: Workload, count: int, folder: Path, setting: Setting):
        engine, accuracy = (DISCRETE, 1e-3) if setting.accuracy is None else (CENIC, setting.accuracy)
        scenario = workload.scenario(count, folder, time_step=setting.step, engine=engine, accuracy=accuracy)
        contact = setting.engine.rpartition(", ")[2]
        if contact in CONTACT_APPROXIMATIONS:
            scenario = replace(scenario, contact_approximation=contact)
        self.twin = Twin(scenario)
        self._topics = [f"/{robot}/forward_velocity_controller/commands" for robot in self.twin.robots]
        self._joints = [commanded(plan) for plan in self.twin.built.plans]
        boxes = workload.placed_boxes(count, scenario.robots)
        self._loose = [index for index, box in enumerate(boxes) if box.mass is not None]

    def __del__(self) -> None:
        if hasattr(self, "twin"):
            self.twin.close()

    def command(self, velocities: np.ndarray) -> None:
        """Command joint velocities."""
        if not velocities.size:
            return
        for topic, values in zip(self._topics, velocities.tolist(), strict=True):
            self.twin.publish(topic, values)

    def advance_to(self, time: float) -> None:
        """Advance to a time (s)."""
        self.twin.advance_to(time)

    def python_time(self, run: Callable[[], object]) -> float:
        """Return the wall time (s) of a run without Drake's part: advancing, and solving for the published efforts."""
        twin, clock = self.twin, _ClockedSimulator(self.twin)
        twin._session.physics.simulator = clock
        try:
            begin = perf_counter()
            run()
            return perf_counter() - begin - clock.time
        finally:
            twin._session.physics.simulator = clock.simulator

    def positions(self) -> np.ndarray:
        """Return the positions of the commanded joints."""
        rows = []
        for robot, joints in zip(self.twin.robots, self._joints, strict=True):
            state = self.twin.robot_state(robot)
            rows.append([state.positions[state.joints.index(joint)] for joint in joints])
        return np.array(rows)

    def centers(self) -> np.ndarray:
        """Return the positions of the loose boxes' centers."""
        plant = self.twin.plant
        return centers(plant, plant.GetMyContextFromRoot(self.twin.context), self._loose)


class _ClockedSimulator:
    """A twin's simulator that measures its own wall time (s)."""

    def __init__(self, twin: Twin):
        self.simulator = twin._session.physics.simulator
        self.time = 0.0
        self._efforts = twin.plant.get_net_actuation_output_port()
        self._plant_context = twin.plant.GetMyContextFromRoot(twin.context)

    def AdvanceTo(self, time: float) -> SimulatorStatus:
        begin = perf_counter()
        status = self.simulator.AdvanceTo(time)
        self._efforts.Eval(self._plant_context)
        self.time += perf_counter() - begin
        return status
