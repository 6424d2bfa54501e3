"""One ``--fit PATH=LOW:HIGH``: a value to find, and the range to search."""

from math import exp, isfinite, log

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError


@dataclass(frozen=True)
class Fitted:
    """A value to find.

    The search sees a share of the range, 0 to 1: of its logarithm where the range is above zero, as masses and
    frictions are known by factors.

    Attributes:
        path: Its path, as `drake_twin.sweeps.variation` has them.
        low: The lower end of the range.
        high: The upper end.
    """

    path: str
    low: float
    high: float

    @classmethod
    def parse(cls, text: str) -> "Fitted":
        """Read ``PATH=LOW:HIGH``.

        Raises:
            InputError: If the text is not one, or the range is empty.
        """
        path, _, spec = (part.strip() for part in text.partition("="))
        ends = spec.split(":")
        try:
            low, high = map(float, ends)
        except ValueError:
            path = ""
        if not path:
            raise InputError(f"--fit {text}: it must read PATH=LOW:HIGH, for example friction=0.05:1.2")
        if not (isfinite(low) and isfinite(high) and low < high):
            raise InputError(f"--fit {text}: the lower end must be less than the upper one, and both finite")
        return cls(path, low, high)

    @property
    def is_factor(self) -> bool:
        """Whether the search sees the logarithm."""
        return self.low > 0

    def at(self, share: float) -> float:
        """Return the value at a share of the range."""
        share = min(max(share, 0.0), 1.0)
        if self.is_factor:
            return min(max(exp(log(self.low) + share * log(self.high / self.low)), self.low), self.high)
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """Return the share of the range at which a value lies, within 0 to 1."""
        value = min(max(value, self.low), self.high)
        if self.is_factor:
            return log(value / self.low) / log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def error(self, share: float, of_share: float) -> float:
        """Return the error of the value from that of its share."""
        slope = self.at(share) * log(self.high / self.low) if self.is_factor else self.high - self.low
        return abs(slope * of_share)
