"""The GPIOs of a robot's sub-diagram, connected to the controllers that use them."""

from collections.abc import Mapping

from pydrake.systems.framework import DiagramBuilder

from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.interface import Interface
from drake_twin.diagram.plant_inputs import free_name
from drake_twin.diagram.update_periods import whole_steps
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.gpio_hardware import GpioHardware, GpioState


def add_gpios(
    builder: DiagramBuilder, plan: RobotPlan, controllers: Mapping[str, Controller], time_step: float
) -> GpioHardware | None:
    """Add the hardware of a robot's GPIOs, if a controller reads or writes one.

    Args:
        builder: The builder of the robot's sub-diagram, with its controllers.
        plan: The robot.
        controllers: Its controllers.
        time_step: The physics step (s).
    """
    gpios = plan.description.gpios
    writing = {name: item for name, item in controllers.items() if any(claim.joint in gpios for claim in item.claims)}
    reading = [item for item in controllers.values() if "gpio_states" in item.robot_inputs]
    if not writing and not reading:
        return None
    commands = {Interface(gpio.name, name): value for gpio in gpios.values() for name, value in gpio.commands.items()}
    indices = {interface: index for index, interface in enumerate(commands)}
    states = [
        GpioState(value, indices.get(Interface(gpio.name, name), -1))
        for gpio in gpios.values()
        for name, value in gpio.states.items()
    ]
    sources = {name: [indices.get(item, -1) for item in each.interfaces] for name, each in writing.items()}
    steps = whole_steps(plan.manager.update_rate, time_step)
    hardware: GpioHardware = builder.AddNamedSystem(
        free_name(builder, "gpios"), GpioHardware([*commands.values()], states, sources, steps * time_step)
    )
    for name, controller in writing.items():
        builder.Connect(controller.get_command_interfaces_output_port(), hardware.get_controller_input_port(name))
    for controller in reading:
        builder.Connect(hardware.get_gpio_states_output_port(), controller.robot_inputs["gpio_states"])
    return hardware
