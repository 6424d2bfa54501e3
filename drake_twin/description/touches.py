"""What tells that a model has touched another one for some time, as gz-sim's TouchPlugin does, as plain data."""

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_plugins import CannotWorkError, PluginReader, plugin_node_name
from drake_twin.findings import Place


@dataclass(frozen=True)
class TouchDetector:
    """A touch that is told once.

    Attributes:
        name: The plugin's name.
        target: A part of the names of the collision shapes that count.
        time: How long one of them has to be touched without a break (s).
        topic: The namespace of its topics in gz's transport; ``{model}`` stands for the model.
        collisions: The model's own shapes that count; without any, all that have a contact sensor.
        is_enabled: Whether it looks from the start on.
        place: Where it was written.
    """

    name: str
    target: str
    time: float
    topic: str
    collisions: tuple[str, ...] = ()
    is_enabled: bool = False
    place: Place = Place("")

    def is_met(self, own: str, other: str) -> bool:
        """Tell whether a contact of a shape of the model with another one counts.

        Args:
            own: The name of the model's shape, ``model::link::collision``.
            other: That of the other one.
        """
        is_own = not self.collisions or any(own == name or own.endswith(f"::{name}") for name in self.collisions)
        return is_own and any(self.target in spelling for name in (own, other) for spelling in _spellings(name))


@dataclass(frozen=True)
class EnableTouch:
    """Lets the detectors with a namespace of topics in gz's transport look from now on, or no longer."""

    topic: str
    is_enabled: bool


def read_touch(plugin: PluginReader) -> TouchDetector:
    """Read ``gz-sim-touchplugin-system``.

    Raises:
        CannotWorkError: If a required element is missing.
        InputError: If a value is invalid; with file and line.
    """
    target, time = plugin.text("target", ""), plugin.number("time", 0.0)
    for tag in ("target", "time"):
        if not plugin.has(tag):
            raise CannotWorkError(f"<{tag}> is missing")
    space = plugin.text("namespace", "model/{model}/touch").strip("/")
    return TouchDetector(
        name=plugin_node_name(plugin.plugin),
        target=target,
        time=time,
        topic=f"/{space}",
        collisions=plugin.texts("collision"),
        is_enabled=plugin.flag("enabled", False),
        place=plugin.plugin.place,
    )


def _spellings(name: str) -> tuple[str, ...]:
    """Return how gz-sim and its files spell the name of a shape."""
    *models, link, shape = ["", "", *name.split("::")][-max(3, name.count("::") + 1) :]
    whole = "".join(f"model/{model}/" for model in models)
    return name, name.replace("::", "/"), f"{whole}link/{link}/collision/{shape}"
