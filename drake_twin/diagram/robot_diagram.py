"""A robot's sub-diagram: its controllers, its sensors and its joint servo, connected to each other."""

from collections.abc import Mapping
from dataclasses import field

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Diagram, DiagramBuilder, OutputPort
from pydrake.systems.primitives import DiscreteTimeDelay

from drake_twin.controllers.base_controller import Controller, ControllerSetup, MovesSurfaces, Upstream
from drake_twin.controllers.body_forces import ForceController, RobotBody
from drake_twin.controllers.joint_state_broadcaster import JointStateBroadcaster, JointStateBroadcasterParameters
from drake_twin.controllers.periodic_controller import COMMANDED_MOTION, TRUE_STATE, PeriodicController
from drake_twin.controllers.registry import JOINT_STATE_BROADCASTER, controller_class
from drake_twin.dataclass import dataclass
from drake_twin.diagram.gpios import add_gpios
from drake_twin.diagram.measurement_delay import MeasurementDelay
from drake_twin.diagram.plant import RobotInPlant
from drake_twin.diagram.plant_inputs import PlantInputs, free_name
from drake_twin.diagram.robot_sensors import SensorPort, SensorSurroundings, add_read_sensors
from drake_twin.diagram.servo_assignment import assign
from drake_twin.diagram.servo_gains import BRAKE, DOWN, EFFORT, FREE, MODES, REST, UP, velocity_limit
from drake_twin.diagram.update_periods import update_period, update_steps, whole_steps
from drake_twin.errors import InputError, TwinError, described
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.planning.controller_plan import ACTIVE, UNLOADED, ControllerPlan
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.gpio_hardware import GpioHardware
from drake_twin.systems.joint_servo import COMMANDS, JointServo


@dataclass(frozen=True)
class RobotDiagram:
    """A robot's sub-diagram and its parts.

    Attributes:
        diagram: The sub-diagram.
        controllers: Controller name → its system, in the order in which they are activated.
        servo: The system that combines the controllers' commands; None for a robot without actuators.
        gpios: The hardware of its GPIOs; None if no controller uses one.
        joints: The joint of each actuator; None for one that models friction.
        plant_inputs: Input port → the plant's output port to connect; only ports that a system needs.
        always_published: Output port → message type of the topics that no controller publishes.
        broadcaster: The system with these ports.
        sensors: The output ports of the topics of sensors that controllers read.
        warnings: Update rates that cannot be met, parameters without effect.
        delays: The plant's port → the system that delays it for the controllers.
    """

    diagram: Diagram
    controllers: dict[str, Controller]
    servo: JointServo | None
    gpios: GpioHardware | None
    joints: tuple[str | None, ...]
    plant_inputs: dict[str, OutputPort]
    broadcaster: JointStateBroadcaster
    always_published: dict[str, str] = field(default_factory=dict)
    sensors: tuple[SensorPort, ...] = ()
    warnings: tuple[str, ...] = ()
    delays: Mapping[str, DiscreteTimeDelay] = field(default_factory=dict)

    def forces(self) -> list[tuple[ForceController, OutputPort]]:
        """Return the controllers that exert forces, each with the diagram's port that has its ``signals``."""
        return [
            (controller, self.diagram.GetOutputPort(f"{name}/signals"))
            for name, controller in self.controllers.items()
            if isinstance(controller, ForceController)
        ]

    def surfaces(self) -> list[tuple[str, tuple[str, ...], OutputPort]]:
        """Return the controllers that move surfaces: name, links, and the diagram's port that has their speeds."""
        return [
            (
                name,
                tuple(controller.surfaces(controller.setup.parameters)),
                self.diagram.GetOutputPort(f"{name}/surface_speeds"),
            )
            for name, controller in self.controllers.items()
            if isinstance(controller, MovesSurfaces)
        ]


def build_robot_diagram(plan: RobotPlan, surroundings: SensorSurroundings, in_plant: RobotInPlant) -> RobotDiagram:
    """Build a robot's sub-diagram.

    Its input ports are those of ``plant_inputs``, ``<controller>/<topic>`` and ``<controller>/<vector input>``; its
    output ports are ``desired_state`` and, where an effort may be commanded, ``actuation`` (to the plant),
    ``state_estimated``, ``<controller>/<topic>`` and those of ``always_published``.

    Args:
        plan: The robot.
        surroundings: The finalized plant, the physics step (or the grid of a continuous plant) and what sensors need.
        in_plant: The robot in the plant.
    """
    plant, time_step = surroundings.plant, surroundings.time_step
    instance, layout = in_plant.instance, in_plant.layout
    builder = DiagramBuilder()
    inputs = PlantInputs(builder)
    late = MeasurementDelay(builder, inputs, plan.robot.measurement_delay, time_step)
    from_plant = {
        "state": plant.get_state_output_port(instance),
        "net_actuation": surroundings.ports.net_actuation(instance),
    }
    controllers, warnings = _add_controllers(builder, plan, layout, time_step, continuous=plant.time_step() == 0.0)
    for controller in controllers.values():
        if isinstance(controller, ForceController):
            controller.attach(RobotBody(plant, instance))
    joints = _joints_of_actuators(layout)
    servo = _add_servo(builder, plan, joints, controllers, in_plant, plant) if joints else None
    always_published = {}
    broadcaster = next((item for item in controllers.values() if isinstance(item, JointStateBroadcaster)), None)
    if broadcaster is None:
        broadcaster = _add_broadcaster(builder, plan, layout, time_step)
        for name, port in broadcaster.robot_inputs.items():
            late.connect(from_plant[name], name, port)
        if plan.description.movable_joints and all(item.type != JOINT_STATE_BROADCASTER for item in plan.controllers):
            always_published = dict(broadcaster.published)
        for topic in always_published:
            builder.ExportOutput(broadcaster.GetOutputPort(topic), topic)
    builder.ExportOutput(broadcaster.get_state_estimated_output_port(), "state_estimated")
    gpios = add_gpios(builder, plan, controllers, time_step)
    for name, controller in controllers.items():
        for source, port in controller.robot_inputs.items():
            if source in from_plant:
                late.connect(from_plant[source], source, port)
            elif source == TRUE_STATE:
                inputs.connect(from_plant["state"], "state", port)
            elif source == COMMANDED_MOTION and servo is not None:
                builder.Connect(servo.get_commanded_motion_output_port(), port)
        _wire_controller(builder, name, controller, controllers)
    sensors, about_sensors = add_read_sensors(builder, plan, instance, surroundings, controllers, inputs)
    warnings += about_sensors
    diagram = builder.Build()
    diagram.set_name(plan.name)
    return RobotDiagram(
        diagram,
        controllers,
        servo,
        gpios,
        joints,
        inputs.needed,
        broadcaster,
        always_published,
        sensors,
        warnings,
        late.systems,
    )


def _add_broadcaster(
    builder: DiagramBuilder, plan: RobotPlan, layout: StateLayout, time_step: float
) -> JointStateBroadcaster:
    """Add a broadcaster for a robot whose files have none: the states of its joints are published in any case."""
    parameters = JointStateBroadcasterParameters(frame_id="")
    period = whole_steps(plan.manager.update_rate, time_step) * time_step
    setup = ControllerSetup("joint_state_broadcaster", parameters, (), plan.description, layout, update_period=period)
    broadcaster: JointStateBroadcaster = builder.AddNamedSystem(
        free_name(builder, setup.name), JointStateBroadcaster(setup)
    )
    return broadcaster


def _add_controllers(
    builder: DiagramBuilder, plan: RobotPlan, layout: StateLayout, time_step: float, *, continuous: bool
) -> tuple[dict[str, Controller], tuple[str, ...]]:
    """Add a system for each controller that can be activated now or later."""
    usable = {item.name: item for item in plan.controllers if item.problem is None}
    depths = {name: _depth(name, usable) for name in usable}
    controllers: dict[str, Controller] = {}
    warnings = _too_fast(plan, time_step)
    per_cycle = whole_steps(plan.manager.update_rate, time_step)
    for name, item in sorted(usable.items(), key=lambda entry: depths[entry[0]]):  # a chain is added from its upper end
        steps = update_steps(item, per_cycle, time_step)
        odometry_rate = None if item.wiring is None else item.wiring.odometry_rate
        setup = ControllerSetup(
            name=name,
            parameters=item.parameters,
            claims=item.claims,
            description=plan.description,
            layout=layout,
            update_period=steps * time_step if continuous else update_period(steps, time_step),
            update_offset=min(depths[name], steps - 1) * time_step,
            namespace=plan.robot.topic_namespace,
            frame_prefix=plan.frame_prefix,
            upstream={
                other: Upstream(controllers[other].get_command_interfaces_output_port().size(), indices)
                for other, indices in _upstream(item, usable).items()
            },
            true_odometry=item.wiring is not None and item.wiring.true_odometry,
            physics_step=0.0 if continuous else time_step,
            position_time_constant=plan.joints.position_time_constant,
            tells_of_motion=True,
            active_at_start=item.state == ACTIVE,
            measures_late=plan.robot.measurement_delay > 0,
            robot=plan.name,
            publication_period=0.0 if odometry_rate is None else whole_steps(odometry_rate, time_step) * time_step,
        )
        kind = controller_class(item.type)
        assert kind is not None, "a controller of an unknown type has a problem"
        try:
            controllers[name] = builder.AddNamedSystem(name, kind(setup))
        except TwinError:
            raise
        except Exception as error:  # of a class from outside
            raise InputError(f"{plan.name}: controller {name} ({item.type}): {described(error)}") from error
        warnings += [f"controller {name}: {warning}" for warning in controllers[name].warnings]
    return {name: controllers[name] for name in usable}, tuple(warnings)


def _too_fast(plan: RobotPlan, time_step: float) -> list[str]:
    """Return warnings of update rates higher than that of the physics, one sentence for each rate."""
    loaded = [item for item in plan.controllers if item.state != UNLOADED and item.wiring is None]
    rates = {f"controller {item.name}": item.update_rate for item in loaded}
    if loaded:
        rates["the controller manager"] = plan.manager.update_rate
    return [
        f"{', '.join(name for name in rates if rates[name] == rate)}: the update rate of {rate:g} Hz is"
        f" higher than that of the physics, which steps every {time_step:g} s: reduced to {1 / time_step:g} Hz"
        for rate in sorted({rate for rate in rates.values() if rate * time_step > 1 + 1e-9})
    ]


def _upstream(item: ControllerPlan, others: Mapping[str, ControllerPlan]) -> dict[str, tuple[int, ...]]:
    """Return the controllers that claim references of this one, and for each the indices of its values by reference."""
    references = item.reference_interfaces
    return {
        name: tuple(other.claims.index(reference) if reference in other.claims else -1 for reference in references)
        for name, other in others.items()
        if any(reference in other.claims for reference in references)
    }


def _depth(name: str, controllers: Mapping[str, ControllerPlan]) -> int:
    """Return the number of controllers above this one in a chain."""
    return max((1 + _depth(other, controllers) for other in _upstream(controllers[name], controllers)), default=0)


def _joints_of_actuators(layout: StateLayout) -> tuple[str | None, ...]:
    joints: list[str | None] = [None] * layout.num_actuators
    for joint, actuator in layout.efforts.items():
        joints[actuator] = joint
    return tuple(joints)


def _add_servo(
    builder: DiagramBuilder,
    plan: RobotPlan,
    joints: tuple[str | None, ...],
    controllers: Mapping[str, Controller],
    in_plant: RobotInPlant,
    plant: MultibodyPlant,
) -> JointServo:
    description = plan.description
    fastest = np.array([velocity_limit(description, joint) for joint in joints])
    limits = np.full((3, len(joints), 2), [-np.inf, np.inf])
    for index, joint in enumerate(joints):
        if joint is None:
            continue
        effort = description.joints_by_name[joint].limits.effort
        # The motor's, whether or not commands are clamped.
        limits[1:, index] = (-fastest[index], fastest[index]), (-effort, effort)
        for row, interface in enumerate(COMMANDS if plan.manager.enforce_command_limits or plan.follows_mujoco else ()):
            lower, upper = description.limits_of_command(joint, interface, of_joint=plan.manager.enforce_command_limits)
            if lower <= upper:
                limits[row, index] = max(lower, limits[row, index, 0]), min(upper, limits[row, index, 1])
    driving = {name: item for name, item in controllers.items() if item.claims}
    active = {item.name for item in plan.controllers if item.state == ACTIVE}
    holds = [plan.joints.start_positions.get(joint or "", 0.0) for joint in joints]
    assignment = assign(joints, driving, active, holds, hold_joints=plan.joints.are_held)
    as_position = None
    if plant.time_step() == 0.0:
        as_position = {
            mode: [0.0 if servo is None else servo.velocity_as_position(mode) for servo in in_plant.gains]
            for mode in MODES
        }
    still = np.zeros(len(joints)).tolist()
    own_velocities = {BRAKE: still, REST: still, UP: fastest.tolist(), DOWN: (-fastest).tolist()}
    sizes = {name: len(item.interfaces) for name, item in driving.items()}
    has_efforts = any(interface.name == "effort" for item in driving.values() for interface in item.interfaces)
    # An effort acts up to the joint's velocity limit: see `effort_gains`.
    limited = {
        index: (plant.get_joint_actuator(actuator), float(fastest[index]))
        for index, actuator in enumerate(plant.GetJointActuatorIndices(in_plant.instance))
        if (gains := in_plant.gains[index]) is not None and gains.effort.d > gains.of(FREE).d
    }
    servo: JointServo = builder.AddNamedSystem(
        free_name(builder, "joint_servo"),
        JointServo(
            sizes,
            assignment,
            limits[..., 0],
            limits[..., 1],
            as_position,
            own_velocities,
            {EFFORT: limited} if has_efforts else None,
            [f"{plan.name}: joint {joint}" for joint in joints],
        ),
    )
    for name, controller in driving.items():
        builder.Connect(controller.get_command_interfaces_output_port(), servo.get_controller_input_port(name))
    builder.ExportOutput(servo.get_desired_state_output_port(), "desired_state")
    # The actuation port is not connected if no effort can be commanded, because reading it takes time.
    if has_efforts:
        builder.ExportOutput(servo.get_actuation_output_port(), "actuation")
    return servo


def _wire_controller(
    builder: DiagramBuilder, name: str, controller: Controller, controllers: Mapping[str, Controller]
) -> None:
    for topic in (*controller.subscribed, *controller.actions, *controller.vector_inputs):
        builder.ExportInput(controller.GetInputPort(topic), f"{name}/{topic}")
    for topic in (*controller.published, *controller.vector_outputs):
        builder.ExportOutput(controller.GetOutputPort(topic), f"{name}/{topic}")
    if isinstance(controller, ForceController):
        builder.ExportOutput(controller.GetOutputPort("signals"), f"{name}/signals")
    if isinstance(controller, MovesSurfaces):
        builder.ExportOutput(controller.GetOutputPort("surface_speeds"), f"{name}/surface_speeds")
    if isinstance(controller, PeriodicController):
        for other in controller.setup.upstream:
            builder.Connect(
                controllers[other].get_command_interfaces_output_port(), controller.get_upstream_input_port(other)
            )
