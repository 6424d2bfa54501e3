"""Drake's own controller: an InverseDynamicsController drives the arm through vector ports.

Run it: python diagrams/inverse_dynamics_arm.py

The root diagram has the arm's state as a vector port. A drake_twin/VectorCommandController takes a vector of efforts.
Between the two stands any Drake system; here one that calculates with a plant of its own.
"""

import numpy as np
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.controllers import InverseDynamicsController
from pydrake.systems.primitives import ConstantVectorSource, MatrixGain

from drake_twin import TwinBuilder

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
DRIVEN = ["joint_1", "joint_2", "joint_3"]  # the gripper's joint_4 and joint_5 stay with the twin's servos
TARGET = [0.8, 0.4, -0.5, 0.0, 0.0]  # rad


def model_of(plan):
    """Return a plant of the robot alone, as any Drake program makes one; without a scene graph it skips meshes."""
    plant = MultibodyPlant(time_step=0.0)
    Parser(plant).AddModelsFromString(plan.description.text, "urdf")  # the URDF that xacro expanded
    for joint in plan.description.movable_joints:
        plant.AddJointActuator(joint.name, plant.GetJointByName(joint.name))
    plant.Finalize()
    return plant


def add_controller(builder, parts):
    """Connect the controller; the twin calls this before it builds its diagram."""
    controller = InverseDynamicsController(model_of(parts.plans[0]), [100.0] * 5, [0.0] * 5, [20.0] * 5, False)
    builder.AddNamedSystem("inverse_dynamics", controller)
    target = builder.AddNamedSystem("target", ConstantVectorSource([*TARGET, *np.zeros(5)]))
    three_of_five = builder.AddNamedSystem("three_of_five", MatrixGain(np.eye(5)[:3]))
    builder.Connect(parts.output("arm", "state_estimated"), controller.get_input_port_estimated_state())
    builder.Connect(target.get_output_port(), controller.get_input_port_desired_state())
    builder.Connect(controller.get_output_port_control(), three_of_five.get_input_port())
    builder.Connect(three_of_five.get_output_port(), parts.input("arm", "efforts/command"))


twin = (
    TwinBuilder()
    .robot("arm", ARM, active_controllers=["joint_state_broadcaster"])
    .controller("arm", "efforts", "drake_twin/VectorCommandController", {"joints": DRIVEN})
    .system(add_controller)
    .build()
)
for time in (0.25, 0.5, 1.0, 2.0, 3.0):
    twin.advance_to(time)
    print(f"{time:4.2f} s:", *(f"{position:7.4f}" for position in twin.robot_state("arm").positions[:3]))
print("efforts (N·m):", *(f"{effort:.2f}" for effort in twin.robot_state("arm").efforts[:3]))
assert np.allclose(twin.robot_state("arm").positions[:3], TARGET[:3], atol=2e-3)
