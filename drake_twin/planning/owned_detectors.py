"""What notices performers or touches, with its model, its number and its topic in ROS."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Generic, TypeVar

from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import of_model

if TYPE_CHECKING:
    from drake_twin.description.performers import PerformerDetector
    from drake_twin.description.touches import TouchDetector

_Detector = TypeVar("_Detector", "PerformerDetector", "TouchDetector")


@dataclass(frozen=True)
class OwnedDetector(Generic[_Detector]):
    """What notices performers or touches.

    Attributes:
        model: The robot or the model of the world that has it.
        number: Its number among those of its model, from 0.
        detector: The detector, with its topic in gz.
        topic: Its topic in ROS.
    """

    model: str
    number: int
    detector: _Detector
    topic: str


def owned_detectors(
    found: "Iterable[tuple[str, _Detector]]", bridged: Mapping[str, str], below: str = ""
) -> "Iterator[OwnedDetector[_Detector]]":
    """Yield detectors with their numbers and topics.

    Args:
        found: The model of each, and the detector.
        bridged: Topic in gz → topic in ROS, of all bridges.
        below: What the topic has behind the detector's own.
    """
    numbers: dict[str, int] = {}
    for model, detector in found:
        number = numbers[model] = numbers.get(model, -1) + 1
        gz = of_model(detector.topic, model)
        yield OwnedDetector(model, number, replace(detector, topic=gz), bridged.get(gz + below, gz + below))
