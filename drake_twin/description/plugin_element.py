"""A ``<plugin>`` of a robot or a world as plain data."""

from collections.abc import Mapping
from dataclasses import field

from drake_twin.dataclass import dataclass
from drake_twin.findings import Place


@dataclass(frozen=True)
class PluginElement:
    """An element of a ``<plugin>``: its tag, its attributes, its text and the elements inside it."""

    tag: str
    attributes: Mapping[str, str] = field(default_factory=dict)
    text: str = ""
    inside: "tuple[PluginElement, ...]" = ()


@dataclass(frozen=True)
class GazeboPlugin:
    """A ``<plugin>`` of a ``<gazebo>`` tag, or of an SDF's model.

    Attributes:
        filename: Its library.
        name: Its name; gz's plugins give their class.
        parameters: The controllers' YAML files it names.
        namespace: The text of ``<ros><namespace>``.
        elements: Tag → the texts of its elements of that tag, in file order; ``ros/remapping`` for one inside another.
        place: Where it was written.
        tree: Its elements with their attributes, in file order.
    """

    filename: str
    name: str
    parameters: tuple[str, ...] = ()
    namespace: str | None = None
    elements: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    place: Place = field(default=Place(""), compare=False)
    tree: tuple[PluginElement, ...] = ()
