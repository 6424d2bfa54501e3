"""The ROS 2 services of a running twin: requests become calls of `Twin`, and what it says becomes responses."""

from drake_twin.services.offered import services_of
from drake_twin.services.registry import Service

__all__ = ["Service", "services_of"]
