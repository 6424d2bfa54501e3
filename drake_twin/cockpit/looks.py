"""Which robots the open pages show, so that nothing is told of the others."""

from collections.abc import Collection, Iterable

_PATIENCE = 60  # snapshots, about 4 s, for which a look holds without a tab asking again


class Looks:
    """What tabs have said that they show.

    Attributes:
        robots: Robot → snapshots that still tell of its joints and controllers; None until a tab has said so.
    """

    def __init__(self) -> None:
        self.robots: dict[str, int] | None = None
        self._efforts = 0

    def at_robots(self, names: Iterable[str], known: Collection[str]) -> None:
        """Note that a tab shows these robots, of those that are known, and no others."""
        self.robots = (self.robots or {}) | dict.fromkeys([name for name in names if name in known], _PATIENCE)

    def at_efforts(self) -> None:
        """Note that a tab shows efforts."""
        self._efforts = _PATIENCE

    @property
    def need_efforts(self) -> bool:
        """Whether a tab shows efforts."""
        return self._efforts > 0

    def pass_snapshot(self) -> None:
        """Note that a snapshot was made."""
        self._efforts -= 1
        if self.robots is not None:
            self.robots = {name: left - 1 for name, left in self.robots.items() if left > 1}
