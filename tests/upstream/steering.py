"""What the tests of the steering controllers assert alike; each file has its own lines and parameters.

Upstream calls its controllers with joints that do not move: the first update at time zero sees them at rest.
"""

from collections.abc import Iterable, Mapping
from math import isnan
from typing import Any

from drive_harness import Driven

from drake_twin.controllers.base_controller import Upstream
from upstream.suite import Suite, near

THRESHOLD = 1e-6  # upstream's COMMON_THRESHOLD


def add_scenarios(
    suite: Suite,
    kind: str,
    parameters: Mapping[str, Any],
    commands: tuple[float, ...],
    driven: int,
    lines: Mapping[str, Iterable[int]],
) -> None:
    """Add the scenarios of one controller; ``lines`` has those of each, in upstream's order."""
    before = (2.2, 4.4)  # of the steering joints in upstream's test
    expected = [near(command, THRESHOLD) for command in commands]
    names = [f"{joint}/velocity" for joint in parameters["traction_joints_names"]]
    names += [f"{joint}/position" for joint in parameters["steering_joints_names"]]

    def drive(**setup: Any) -> Driven:
        return Driven(kind, parameters, **setup)

    def pairs(what: str, values: Iterable[Any]) -> list[tuple[int, Any]]:
        return list(zip(lines[what], values, strict=True))

    geometry = [name for name, value in parameters.items() if isinstance(value, float) and name != "reference_timeout"]
    of_the_file = ("traction_joints_names", "steering_joints_names", "open_loop")
    of_the_file += ("velocity_rolling_window_size", "position_feedback", *geometry)

    def as_given(value: Any) -> Any:
        return tuple(value) if isinstance(value, list) else value

    @suite.scenario(dict(pairs("parameters", [as_given(parameters[name]) for name in of_the_file])))
    def parameters_are_read():
        read = drive().controller.setup.parameters
        return pairs("parameters", [getattr(read, name) for name in of_the_file])

    @suite.scenario(dict(pairs("claims", [len(names), *names])))
    def command_interfaces():
        claims = [str(claim) for claim in drive().controller.claims]
        return pairs("claims", [len(claims), *claims])

    @suite.scenario(dict(pairs("references", [2, {"linear/velocity", "angular/velocity"}, {"velocity"}])))
    def reference_interfaces():
        controller = drive().controller
        references = controller.reference_interfaces(controller.setup.parameters, controller.setup.description)
        names = {str(each) for each in references}
        return pairs("references", [len(references), names, {each.name for each in references}])

    @suite.scenario(dict(pairs("reactivated", [True, True])))
    def reactivated():
        dut = drive()
        dut.controller.deactivate(dut.context)
        deactivated = isnan(dut.commands[0])
        dut.activate()
        return pairs("reactivated", [deactivated, isnan(dut.commands[0])])

    @suite.scenario(dict(pairs("update", expected)))
    def command_of_the_topic():
        dut = drive()
        dut.send(x=0.1, z=0.2)
        dut.advance(0.005)
        return pairs("update", dut.commands)

    @suite.scenario(dict(pairs("chained", expected)))
    def command_of_the_references():
        dut = drive(upstream={"above": Upstream(2, (0, 1))})
        dut.controller.GetInputPort("above").FixValue(dut.context, [0.1, 0.2])
        dut.advance(0.005)
        return pairs("chained", dut.commands)

    @suite.scenario(dict(pairs("received", [0.0] * driven + list(before[: len(names) - driven]) + 2 * expected)))
    def state_message():
        dut = drive()
        dut.advance(0.0)
        dut.simulator.AdvancePendingEvents()
        first = dut.message("controller_state")
        seen = [*first.linear_velocity_command, *first.steering_angle_command]
        dut = drive()
        dut.send(x=0.1, z=0.2)
        dut.advance(0.005)
        second = dut.message("controller_state")
        seen += [*dut.commands, *second.linear_velocity_command, *second.steering_angle_command]
        return pairs("received", seen)
