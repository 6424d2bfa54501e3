"""Stand-in for ``rclpy.type_hash``."""


class TypeHash:
    """The hash of a type's definition."""

    __slots__ = ["_value", "_version"]

    def __init__(self, version: int = -1, value: bytes = bytes(32)):
        self.version, self.value = version, value

    version = property(lambda self: self._version, lambda self, value: setattr(self, "_version", _checked(value, int)))
    value = property(lambda self: self._value, lambda self, value: setattr(self, "_value", _checked(value, bytes)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TypeHash) and (self.version, self.value) == (other.version, other.value)

    def __hash__(self) -> int:
        return hash((self.version, self.value))

    def __str__(self) -> str:
        if self.version <= 0 or len(self.value) != 32:
            return "INVALID"
        return f"RIHS{self.version:02}_{self.value.hex()}"


def _checked(value: object, kind: type) -> object:
    if not isinstance(value, kind):
        raise AssertionError
    return value
