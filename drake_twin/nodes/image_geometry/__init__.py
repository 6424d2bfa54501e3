"""Stand-in for ``image_geometry``: where points of space are in images."""

from drake_twin.nodes.image_geometry.cameramodels import PinholeCameraModel, StereoCameraModel

__all__ = ["PinholeCameraModel", "StereoCameraModel"]
