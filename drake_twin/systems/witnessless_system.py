"""The base of all systems here: one that Drake need not ask for witness functions."""

from typing import Any, ClassVar

from pydrake.systems.framework import LeafSystem


class WitnesslessSystem(LeafSystem):
    """A ``LeafSystem`` without witness functions.

    Each time a simulator begins to advance, it asks every system for its witness functions, and in one that is written
    in Python it looks for a method of that name. As long as it finds none it looks again, 1 µs each time. pybind11
    remembers that a class overrides nothing once it finds a method which is not Python's: any will do, as it is not
    called.
    """

    DoGetWitnessFunctions: ClassVar[Any] = LeafSystem.get_name
