"""The system of gz-sim that lets a world's wind change and push things, as forces of the world."""

from collections.abc import Iterator, Mapping
from dataclasses import field
from math import inf, sqrt

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import PluginReader
from drake_twin.description.plugin_element import PluginElement
from drake_twin.description.world_plugins import WIND_EFFECTS, WorldPlugin, world_plugin
from drake_twin.values import parse_number

_FACTOR = "force_approximation_scaling_factor"
_NOISES = ("none", "gaussian", "gaussian_quantized")
_OF_NOISE = ("mean", "stddev", "bias_mean", "bias_stddev", "dynamic_bias_stddev", "dynamic_bias_correlation_time")
_NOT_NEGATIVE = ("stddev", "bias_stddev", "dynamic_bias_stddev", "dynamic_bias_correlation_time", "precision")
_POLYNOMIALS = {"px": "x", "qy": "y", "rz": "z"}

Polynomial = tuple[float, float, float, float]


@dataclass(frozen=True)
class Interval:
    """Numbers between two bounds, either of which may be among them."""

    low: float = -inf
    high: float = inf
    has_low: bool = False
    has_high: bool = False

    def least(self, polynomial: Polynomial) -> float:
        """Return the least value of a polynomial in the interval, the largest power first; it may be infinite."""
        a, b, c, _ = polynomial
        return min(_value(polynomial, x) for x in (self.low, self.high, *_turns(a, b, c)) if self.low <= x <= self.high)


@dataclass(frozen=True)
class FieldPiece:
    """A region of the world with ``factor`` · (p(x) + q(y) + r(z)).

    Attributes:
        factor: The factor.
        polynomials: The coefficients of p, q and r, the largest power first.
        region: The x, y and z in it (m).
    """

    factor: float
    polynomials: tuple[Polynomial, Polynomial, Polynomial]
    region: tuple[Interval, Interval, Interval] = (Interval(), Interval(), Interval())

    @property
    def is_everywhere(self) -> bool:
        """Whether its region has no bounds."""
        return all(interval == Interval() for interval in self.region)

    @property
    def constant(self) -> float | None:
        """Its value if that is the same in all of it; else None."""
        if any(any(polynomial[:3]) for polynomial in self.polynomials):
            return None
        return self.factor * sum(polynomial[3] for polynomial in self.polynomials)

    @property
    def least(self) -> float:
        """The least value in it."""
        own = ((self.factor * a, self.factor * b, self.factor * c, self.factor * d) for a, b, c, d in self.polynomials)
        return sum(interval.least(item) for interval, item in zip(self.region, own, strict=True))


@dataclass(frozen=True)
class SwingParameters:
    """How a quantity of the wind follows what is wanted of it.

    Attributes:
        rise: The time constant (s).
        amplitude: Of the sinusoid that is added: of the speed relative to it, of the direction in degrees.
        period: Of that (s).
        noise: The noise that is added, by the attributes of `drake_twin.sensors.noise.Noise`; of the direction in
            degrees.
    """

    rise: float = 1.0
    amplitude: float = 0.0
    period: float = 1.0
    noise: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class WindEffectsParameters:
    """What ``gz-sim-wind-effects-system`` says of the wind.

    Attributes:
        speed: Of the horizontal speed.
        direction: Of the direction.
        vertical: Of the vertical velocity.
        scaling: The force on a link ÷ its mass and its velocity relative to the wind (1/s), by place; no force where
            no piece is.
    """

    speed: SwingParameters = SwingParameters()
    direction: SwingParameters = SwingParameters()
    vertical: SwingParameters = SwingParameters()
    scaling: tuple[FieldPiece, ...] = ()


@world_plugin("gz-sim-wind-effects-system")
def wind_effects_system(plugin: PluginReader) -> WorldPlugin:
    """Convert ``gz-sim-wind-effects-system``: a wind that rises and swings, and pushes links with ``<enable_wind>``."""
    parameters = WindEffectsParameters(
        _swing(plugin, "horizontal/magnitude", "sin/amplitude_percent"),
        _swing(plugin, "horizontal/direction", "sin/amplitude"),
        _swing(plugin, "vertical"),
        tuple(_pieces(plugin)),
    )
    for tag in (tag for tag in plugin.plugin.elements if tag.partition("/")[0] == _FACTOR):
        plugin.has(tag)
    return WorldPlugin(WIND_EFFECTS, parameters)


def _swing(plugin: PluginReader, path: str, amplitude: str = "") -> SwingParameters:
    rise, period = _positive(plugin, f"{path}/time_for_rise"), 1.0
    if amplitude:
        period = _positive(plugin, f"{path}/sin/period")
    swing = plugin.number(f"{path}/{amplitude}", 0.0) if amplitude else 0.0
    return SwingParameters(rise, swing, period, _noise(plugin, f"{path}/noise"))


def _positive(plugin: PluginReader, tag: str) -> float:
    value = plugin.number(tag, 1.0)
    if value <= 0.0:
        raise plugin.error(f"<{tag}> is {value:g}, and has to be above zero")
    return value


def _noise(plugin: PluginReader, path: str) -> dict[str, float]:
    found = next(_at(plugin.plugin.tree, path.split("/")), None)
    if found is None:
        return {}
    inside = {item.tag: item.text for item in found.inside}
    kind = found.attributes.get("type") or inside.get("type") or "none"
    if kind not in _NOISES:
        raise plugin.error(f"<{path}> has the type {kind!r}, not one of {', '.join(_NOISES)}")
    plugin.has(f"{path}/type")
    values = {name: plugin.number(f"{path}/{name}", 0.0) for name in (*_OF_NOISE, "precision")}
    for name in _NOT_NEGATIVE:
        if values[name] < 0.0:
            raise plugin.error(f"<{path}/{name}> is {values[name]:g}, and has to be zero or more")
    return {} if kind == "none" else {name: value for name, value in values.items() if value}


def _at(elements: tuple[PluginElement, ...], path: list[str]) -> Iterator[PluginElement]:
    """Yield the elements at a path, only in the first one of each name above them."""
    first = next((item for item in elements if item.tag == path[0]), None)
    if first is not None and len(path) > 1:
        yield from _at(first.inside, path[1:])
    elif first is not None:
        yield from (item for item in elements if item.tag == path[0])


def _pieces(plugin: PluginReader) -> Iterator[FieldPiece]:
    """Yield the pieces of the scaling factor; of its elements the first one counts."""
    found = next(_at(plugin.plugin.tree, [_FACTOR]), None)
    if found is None:
        yield _constant(1.0)
        return
    regions = [item for item in found.inside if item.tag == "when"]
    for item in regions or [found]:
        piece = _piece(plugin, item)
        if piece.least < 0.0:
            raise plugin.error(f"<{_FACTOR}> has values below zero, and has to be zero or more")
        yield piece


def _piece(plugin: PluginReader, item: PluginElement) -> FieldPiece:
    x, y, z = (_interval(plugin, item, axis) for axis in "xyz")
    inside = {each.tag: each.text for each in reversed(item.inside)}
    if not inside:
        return _constant(_number(plugin, item.tag, item.text), (x, y, z))
    p, q, r = (_polynomial(plugin, tag, inside.get(tag, "")) for tag in _POLYNOMIALS)
    factor = _number(plugin, "k", inside["k"]) if "k" in inside else 1.0
    return FieldPiece(factor, (p, q, r), (x, y, z))


def _constant(value: float, region: tuple[Interval, Interval, Interval] | None = None) -> FieldPiece:
    none = (0.0, 0.0, 0.0, 0.0)
    return FieldPiece(value, ((0.0, 0.0, 0.0, 1.0), none, none), region or (Interval(), Interval(), Interval()))


def _interval(plugin: PluginReader, item: PluginElement, axis: str) -> Interval:
    bounds: list[tuple[float, bool]] = []
    for with_bound, without, default in (("ge", "gt", -inf), ("le", "lt", inf)):
        given = [name for name in (f"{axis}{with_bound}", f"{axis}{without}") if name in item.attributes]
        if len(given) > 1:
            raise plugin.error(f"<when> has both {given[0]} and {given[1]}")
        has_bound = bool(given) and given[0].endswith(with_bound)
        bounds.append((_number(plugin, given[0], item.attributes[given[0]]) if given else default, has_bound))
    (low, has_low), (high, has_high) = bounds
    if low > high:
        raise plugin.error(f"<when> has no {axis}: it has to be above {low:g} and below {high:g}")
    return Interval(low, high, has_low, has_high)


def _polynomial(plugin: PluginReader, tag: str, text: str) -> Polynomial:
    values = [_number(plugin, tag, word) for word in (text or "0 0 0 0").split()]
    if len(values) != 4:
        raise plugin.error(f"<{tag}> is {text!r}, which is not four numbers, the coefficient of the cube first")
    a, b, c, d = values
    return a, b, c, d


def _number(plugin: PluginReader, what: str, text: str) -> float:
    try:
        return parse_number(text)
    except ValueError as error:
        raise plugin.error(f"{what} of <{_FACTOR}> is {text!r}, which is {error}") from None


def _value(polynomial: Polynomial, x: float) -> float:
    a, b, c, d = polynomial
    if x not in (inf, -inf):
        return ((a * x + b) * x + c) * x + d
    sign = 1.0 if x > 0.0 else -1.0
    leading = next((value for value in (a * sign, b, c * sign) if value), 0.0)
    return d if leading == 0.0 else inf if leading > 0.0 else -inf


def _turns(a: float, b: float, c: float) -> tuple[float, ...]:
    """Return where the slope of a x³ + b x² + c x + … is zero."""
    if a == 0.0:
        return () if b == 0.0 else (-c / (2.0 * b),)
    inside = b * b - 3.0 * a * c
    return () if inside < 0.0 else tuple((-b + sign * sqrt(inside)) / (3.0 * a) for sign in (1.0, -1.0))
