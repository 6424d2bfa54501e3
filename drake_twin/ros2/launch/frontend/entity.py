from drake_twin.ros2.frontend import Element as Entity

__all__ = ["Entity"]
