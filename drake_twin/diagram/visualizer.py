"""The drawing of the scene on a Meshcat page."""

from math import inf

from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Role, SceneGraph
from pydrake.systems.framework import DiagramBuilder


def add_visualizer(
    builder: DiagramBuilder, scene_graph: SceneGraph, meshcat: Meshcat | None
) -> MeshcatVisualizer | None:
    """Add what draws the illustration shapes on a page on demand; None without a page."""
    if meshcat is None:
        return None
    # The run loop asks for the drawing, in wall time: an event of its own would split CENIC's steps.
    parameters = MeshcatVisualizerParams(role=Role.kIllustration, publish_period=inf)
    visualizer = MeshcatVisualizer.AddToBuilder(builder, scene_graph, meshcat, parameters)
    visualizer.set_name("meshcat_visualizer")
    return visualizer
