"""How old is what a measurement delay lets through."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import PassThrough, TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from drake_twin.diagram.measurement_delay import MeasurementDelay
from drake_twin.diagram.plant_inputs import PlantInputs

STEP = 0.01  # s


@pytest.mark.parametrize(("delay", "steps"), [(0.0, 0), (0.004, 1), (0.01, 1), (0.03, 3), (0.031, 4)])
def test_a_reader_sees_the_value_of_that_many_steps_ago(delay, steps):
    outer, inner = DiagramBuilder(), DiagramBuilder()
    clock = outer.AddSystem(TrajectorySource(PiecewisePolynomial.FirstOrderHold([0.0, 1.0], np.array([[0.0, 1.0]]))))
    reader = inner.AddSystem(PassThrough(1))
    late = MeasurementDelay(inner, PlantInputs(inner), delay, STEP)
    late.connect(clock.get_output_port(), "state", reader.get_input_port())
    inner.ExportOutput(reader.get_output_port(), "read")
    robot = outer.AddSystem(inner.Build())
    outer.Connect(clock.get_output_port(), robot.GetInputPort("state"))
    simulator = Simulator(outer.Build())
    for step in range(1, 10):
        simulator.AdvanceTo(step * STEP)
        (seen,) = robot.GetOutputPort("read").Eval(robot.GetMyContextFromRoot(simulator.get_context()))
        assert seen == pytest.approx(max(0.0, (step - steps) * STEP), abs=1e-12)
