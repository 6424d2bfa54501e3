"""Sensors of a robot: one kind, one file, registered by `sensor`."""

from drake_twin.sensors.registry import sensor

__all__ = ["sensor"]
