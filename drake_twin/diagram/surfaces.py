"""The surfaces of links that controllers move, in the plant."""

from collections.abc import Iterator, Sequence

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex
from pydrake.systems.framework import DiagramBuilder, OutputPort

from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.findings import Finding, Kind
from drake_twin.systems.surface_speeds import SurfaceSpeeds


def move_surfaces(
    builder: DiagramBuilder,
    plant: MultibodyPlant,
    controllers: Sequence[tuple[ModelInstanceIndex, str, Sequence[str], OutputPort]],
) -> Iterator[Finding]:
    """Connect the controllers that move surfaces to the plant.

    Args:
        builder: The root diagram's builder.
        plant: The finalized plant.
        controllers: Of each its robot's model instance, its name, the links, and the port that has their speeds.

    Yields:
        What keeps them from it.
    """
    names = []
    for instance, _, links, _ in controllers:
        bodies = [plant.GetBodyByName(drake_link_name(link), instance) for link in links]
        names.append([body.scoped_name().get_full() for body in bodies])
    port = plant.get_surface_speeds_input_port()
    if builder.IsConnectedOrExported(port):
        what = "a system of yours is connected to the plant's port surface_speeds"
        moved = ", ".join(name for _, name, *_ in controllers)
        yield Finding(Kind.NOT_STARTED, f"{what}: {moved} moves no surface")
        return
    system = builder.AddNamedSystem("surface_speeds", SurfaceSpeeds(names))
    for number, (*_, speeds) in enumerate(controllers):
        builder.Connect(speeds, system.get_input_port(number))
    builder.Connect(system.get_output_port(), port)
