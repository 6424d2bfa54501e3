"""The base of all systems here: one that Drake need not ask for witness functions."""

from typing import Any, ClassVar

from pydrake.systems.framework import LeafSystem


class WitnesslessSystem(LeafSystem):
    """A ``LeafSystem`` without witness functions.

    Each time a simulator begins to advance, it asks every system for its witness functions, and for one that is written
    in Python it looks for a method of that name. As long as it finds none it looks again, which takes longer than a
    step of the physics with some robots; pybind11 remembers a class only once it finds a method there, and finds that
    it is C++. Any one will do: it is never called.
    """

    DoGetWitnessFunctions: ClassVar[Any] = LeafSystem.get_name
