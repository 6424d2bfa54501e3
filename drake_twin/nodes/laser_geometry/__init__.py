"""Stand-in for ``laser_geometry``: laser scans as point clouds."""

from drake_twin.nodes.laser_geometry.laser_geometry import LaserProjection

__all__ = ["LaserProjection"]
