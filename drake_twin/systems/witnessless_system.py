"""The base of all systems here: one without witness functions."""

from typing import Any, ClassVar

from pydrake.systems.framework import LeafSystem


def _looks_up_each_time() -> bool:
    """Tell a pydrake that remembers an override without calling it; later ones (since 1.56) call what they find."""

    class Probe(LeafSystem):
        DoGetWitnessFunctions: ClassVar[Any] = LeafSystem.get_name

    probe = Probe()
    try:
        probe.GetWitnessFunctions(probe.CreateDefaultContext())
    except TypeError:
        return False
    return True


class WitnesslessSystem(LeafSystem):
    """A ``LeafSystem`` without witness functions.

    Each time a simulator begins to advance, it asks every system for its witness functions, and in a Python system
    Drake's older bindings (pybind11, up to 1.55) look for a method of that name. If they find none, they look again the
    next time, for 1 µs. Once they find a method that is not Python's, they remember that the class overrides nothing:
    any method suffices, as it is not called. The newer ones need no help: 50 systems advance in 16 µs with and without
    a base in Python, against 47 and 15 µs of the older ones without and with this method.
    """

    if _looks_up_each_time():
        DoGetWitnessFunctions: ClassVar[Any] = LeafSystem.get_name
