"""The surfaces of links that controllers move, in the plant."""

from collections.abc import Iterator, Sequence

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody
from pydrake.systems.framework import DiagramBuilder, OutputPort

from drake_twin.controllers.registry import controller_class
from drake_twin.controllers.surface_controller import SurfaceController
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.surface_velocity import has_surface_velocity
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan


def give_surfaces(plant: MultibodyPlant, plan: RobotPlan, instance: ModelInstanceIndex) -> None:
    """Give a robot's links the surfaces that its controllers move.

    Args:
        plant: The plant, not yet finalized; it is changed.
        plan: The robot.
        instance: Its model instance.
    """
    for item in plan.controllers:
        kind = None if item.problem is not None else controller_class(item.type)
        if kind is not None and issubclass(kind, SurfaceController):
            for link, axis in kind.surfaces(item.parameters).items():
                body = plant.GetBodyByName(drake_link_name(link), instance)
                plant.SetSurfaceVelocityAxis(body, np.array(axis))


def has_moving_surface(plant: MultibodyPlant, body: RigidBody) -> bool:
    """Tell whether a controller moves the surface of a body."""
    return has_surface_velocity() and plant.GetSurfaceVelocityAxis(body) is not None


def move_surfaces(
    builder: DiagramBuilder,
    plant: MultibodyPlant,
    controllers: Sequence[tuple[ModelInstanceIndex, SurfaceController, OutputPort]],
) -> Iterator[Finding]:
    """Connect the controllers that move surfaces to the plant.

    Args:
        builder: The root diagram's builder.
        plant: The finalized plant.
        controllers: Their robot's model instance, each of them, and its port ``surface_speeds`` on the robot's diagram.

    Yields:
        What keeps them from it.
    """
    if not controllers:
        return
    names = []
    for instance, controller, _ in controllers:
        links = controller.surfaces(controller.setup.parameters)
        bodies = [plant.GetBodyByName(drake_link_name(link), instance) for link in links]
        names.append([body.scoped_name().get_full() for body in bodies])
    port = plant.get_surface_speeds_input_port()
    if builder.IsConnectedOrExported(port):
        what = "a system of yours is connected to the plant's port surface_speeds"
        moved = ", ".join(controller.setup.name for _, controller, _ in controllers)
        yield Finding(Kind.NOT_STARTED, f"{what}: {moved} moves no surface")
        return
    from drake_twin.systems.surface_speeds import SurfaceSpeeds

    system = builder.AddNamedSystem("surface_speeds", SurfaceSpeeds(names))
    for number, (_, _, speeds) in enumerate(controllers):
        builder.Connect(speeds, system.get_input_port(number))
    builder.Connect(system.get_output_port(), port)
