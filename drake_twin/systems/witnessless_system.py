"""The base of all systems here: one without witness functions."""

from typing import Any, ClassVar

from pydrake.systems.framework import LeafSystem


class WitnesslessSystem(LeafSystem):
    """A ``LeafSystem`` without witness functions.

    Each time a simulator begins to advance, it asks every system for its witness functions, and in a Python system
    pybind11 looks for a method of that name. If it finds none, it looks again the next time, for 1 µs. Once it finds a
    method that is not Python's, it remembers that the class overrides nothing: any method suffices, as it is not
    called.
    """

    DoGetWitnessFunctions: ClassVar[Any] = LeafSystem.get_name
