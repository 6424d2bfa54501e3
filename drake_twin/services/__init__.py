"""The ROS 2 services of a running twin: requests become calls of `Twin`, and what it says becomes responses."""

from drake_twin.services.registry import Service, services_of

__all__ = ["Service", "services_of"]
