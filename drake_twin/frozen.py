"""Values that Drake need not copy."""

from typing import Any, Self


class Frozen:
    """Base of frozen dataclasses of frozen fields: a copy of one is itself.

    Drake copies the value of a port, and at each unrestricted update of any system all abstract states, which would
    take Python longer than a step of the physics.
    """

    __slots__ = ()

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self
