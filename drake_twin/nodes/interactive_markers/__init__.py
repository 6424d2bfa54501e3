"""Stand-in for ``interactive_markers``: markers that are dragged in RViz. It has no ``MenuHandler``."""

from drake_twin.nodes.interactive_markers.interactive_marker_server import InteractiveMarkerServer

__all__ = ["InteractiveMarkerServer"]
