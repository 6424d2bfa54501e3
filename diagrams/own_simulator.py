"""A twin's diagram in a Simulator of your own, with a logger on its vector ports.

Run it: python diagrams/own_simulator.py

The diagram is an ordinary Drake diagram: it has commands by default, so a bare Simulator runs it.
"""

import numpy as np
from pydrake.systems.analysis import Simulator
from pydrake.systems.primitives import LogVectorOutput

from drake_twin import TwinBuilder

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
loggers = []


def add_logger(builder, parts):
    loggers.append(LogVectorOutput(parts.output("arm", "state_estimated"), builder, publish_period=0.1))


twin = TwinBuilder().robot("arm", ARM, xacro_args={"use_ros2_control": False}).system(add_logger).build()
simulator = Simulator(twin.diagram)
simulator.AdvanceTo(2.0)

log = loggers[-1].FindLog(simulator.get_context())
for time, (joint_2, joint_3) in zip(log.sample_times()[::5], log.data()[1:3].T[::5], strict=True):
    print(f"{time:.1f} s: joint_2 {joint_2:.3f} rad, joint_3 {joint_3:.3f} rad")

plant = twin.plant
plant_context = plant.GetMyContextFromRoot(simulator.get_context())
print(f"mass {plant.CalcTotalMass(plant_context):.2f} kg, {plant.num_velocities()} velocities")
twin.advance_to(2.0)  # the twin has a simulator and a context of its own
ours = twin.plant.GetPositionsAndVelocities(twin.plant.GetMyContextFromRoot(twin.context))
assert np.allclose(plant.GetPositionsAndVelocities(plant_context), ours, atol=1e-9)
assert log.data()[2, -1] > 0.5
