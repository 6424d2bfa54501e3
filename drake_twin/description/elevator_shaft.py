"""The floors and doors of an elevator, and the orders that move them."""

from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class Shaft:
    """What does not change of an elevator.

    Attributes:
        floors: The position of the cabin's joint at each floor (m).
        doors: The position of each floor's open door (m or rad); closed doors are at zero.
        wait: How long a door stays open (s).
    """

    floors: tuple[float, ...]
    doors: tuple[float, ...]
    wait: float

    def move(self, floor: int) -> int:
        """Return the number of the order that moves the cabin to a floor."""
        return floor

    def open(self, floor: int) -> int:
        """Return the number of the order that opens a floor's door."""
        return len(self.floors) + floor

    def close(self, floor: int) -> int:
        """Return the number of the order that closes a floor's door."""
        return 2 * len(self.floors) + floor
