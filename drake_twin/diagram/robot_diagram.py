"""One robot's sub-diagram: its controllers, its joint servo and its publishers, behind ports named as in ROS."""

from dataclasses import dataclass

from pydrake.systems.framework import Diagram, DiagramBuilder

from drake_twin.description.robot_description import RobotDescription
from drake_twin.diagram.robot_plan import RobotPlan
from drake_twin.systems.ground_truth_publisher import GroundTruthPublisher
from drake_twin.systems.joint_servo import JointServo
from drake_twin.systems.joint_state_publisher import JointStatePublisher
from drake_twin.systems.robot_state_publisher import RobotStatePublisher
from drake_twin.systems.state_layout import StateLayout
from drake_twin.systems.velocity_controller import VelocityController

# Output port → message type. The topic is the port's name below the robot's namespace.
PUBLISHED = {
    "joint_states": "sensor_msgs/msg/JointState",
    "dynamic_joint_states": "control_msgs/msg/DynamicJointState",
    "robot_description": "std_msgs/msg/String",
    "ground_truth/odom": "nav_msgs/msg/Odometry",
}
COMMANDS_TYPE = "std_msgs/msg/Float64MultiArray"


@dataclass(frozen=True)
class RobotDiagram:
    """A robot's sub-diagram and the controllers in it, by name."""

    diagram: Diagram
    controllers: dict[str, VelocityController]


def build_robot_diagram(plan: RobotPlan, layout: StateLayout) -> RobotDiagram:
    """Builds a robot's sub-diagram.

    Its input ports are ``state`` and ``net_actuation`` (from the plant) and ``<controller>/commands``; its output ports
    are ``desired_state`` (to the plant), ``tf``, ``tf_static`` and those of `PUBLISHED`.

    Args:
        plan: the robot.
        layout: where its joints stand in the plant's ports.
    """
    builder = DiagramBuilder()
    description = plan.description
    controllers = {
        controller.name: builder.AddNamedSystem(
            controller.name, VelocityController(controller.joints, controller.lower, controller.upper)
        )
        for controller in plan.controllers
    }
    hold_positions = [0.0] * layout.num_actuators
    for joint, actuator in layout.efforts.items():
        hold_positions[actuator] = plan.start_positions[joint]
    claims = {
        controller.name: [layout.efforts[joint] for joint in controller.joints] for controller in plan.controllers
    }
    servo = builder.AddNamedSystem("joint_servo", JointServo(hold_positions, claims))
    joint_states = builder.AddNamedSystem(
        "joint_state_publisher", JointStatePublisher(_state_interfaces(description), layout)
    )
    robot_state = builder.AddNamedSystem(
        "robot_state_publisher", RobotStatePublisher(description, layout, plan.frame_prefix)
    )
    ground_truth = builder.AddNamedSystem(
        "ground_truth_publisher",
        GroundTruthPublisher(plan.base_frame, layout, plan.spawn_pose if plan.model.is_fixed else None),
    )
    for name, controller in controllers.items():
        builder.Connect(controller.get_velocity_commands_output_port(), servo.get_controller_input_port(name))
        builder.ExportInput(controller.get_commands_input_port(), f"{name}/commands")
    builder.ExportInput(joint_states.get_state_input_port(), "state")
    builder.ConnectInput("state", robot_state.get_state_input_port())
    builder.ConnectInput("state", ground_truth.get_state_input_port())
    builder.ExportInput(joint_states.get_net_actuation_input_port(), "net_actuation")
    builder.ExportOutput(servo.get_desired_state_output_port(), "desired_state")
    builder.ExportOutput(joint_states.get_joint_states_output_port(), "joint_states")
    builder.ExportOutput(joint_states.get_dynamic_joint_states_output_port(), "dynamic_joint_states")
    builder.ExportOutput(robot_state.get_tf_output_port(), "tf")
    builder.ExportOutput(robot_state.get_tf_static_output_port(), "tf_static")
    builder.ExportOutput(robot_state.get_robot_description_output_port(), "robot_description")
    builder.ExportOutput(ground_truth.get_odom_output_port(), "ground_truth/odom")
    diagram = builder.Build()
    diagram.set_name(plan.name)
    return RobotDiagram(diagram, controllers)


def _state_interfaces(description: RobotDescription) -> dict[str, tuple[str, ...]]:
    """Joint → state interfaces: those of ``<ros2_control>``, or all of every movable joint where there is none."""
    movable = {joint.name for joint in description.movable_joints}
    if not description.systems:
        return dict.fromkeys((joint.name for joint in description.movable_joints), ("position", "velocity"))
    interfaces = {
        name: tuple(item.name for item in joint.state_interfaces)
        for name, joint in description.controlled_joints.items()
        if name in movable
    }
    return {name: names for name, names in interfaces.items() if names}
