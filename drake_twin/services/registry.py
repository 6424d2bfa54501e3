"""Services by what they belong to: the twin, a robot, or a node with parameters."""

from collections.abc import Callable, Generator, Mapping
from typing import Any, TypeVar

from drake_twin.dataclass import dataclass
from drake_twin.extensions import Registry

Fields = Mapping[str, Any]  # of a response
Later = Generator[Any, None, Fields]  # a response that takes several frames: it is continued once a frame
SIMULATION_NODE = "/drake_twin"

_Answer = TypeVar("_Answer", bound=Callable[..., Fields | Later])


@dataclass(frozen=True)
class Service:
    """A service of a running twin, or, in the two registries, one that each twin or each robot has.

    Attributes:
        name: Its full name; of each robot's, the one below the robot's namespace.
        type: Its ROS type.
        node: The full name of its node, likewise.
        answer: Takes the request and returns the response's fields, or a generator that does so later; called in the
            simulation's thread. In the registries it takes the twin and, of each robot's, the robot's name before.
        between_advances: Whether it does what a callback cannot do, such as a spawn.
    """

    name: str
    type: str
    node: str
    answer: Callable[..., Fields | Later]
    between_advances: bool = False


_WHERE = "drake_twin.services", ["drake_twin.services"]
OF_TWIN: Registry[Service] = Registry("service of the twin", "twin_service", *_WHERE)
OF_ROBOT: Registry[Service] = Registry("service of robots", "robot_service", *_WHERE)


def twin_service(
    type: str, name: str, node: str = SIMULATION_NODE, *, between_advances: bool = False
) -> Callable[[_Answer], _Answer]:
    """Decorate a function that answers a service of the twin; it takes the twin and the request.

    Args:
        type: The ROS type.
        name: The full name.
        node: The full name of its node.
        between_advances: Whether it does what a callback cannot do.

    Raises:
        InputError: If another function answers a service of the name.
    """

    def register(answer: _Answer) -> _Answer:
        OF_TWIN.add(name, Service(name, type, node, answer, between_advances), answer)
        return answer

    return register


def robot_service(type: str, name: str, node: str) -> Callable[[_Answer], _Answer]:
    """Decorate a function that answers a service of each robot; it takes the twin, the robot and the request.

    Args:
        type: The ROS type.
        name: The name below the node's.
        node: The node's name below the robot's namespace.

    Raises:
        InputError: If another function answers a service of the name.
    """

    def register(answer: _Answer) -> _Answer:
        OF_ROBOT.add(f"{node}/{name}", Service(f"{node}/{name}", type, node, answer), answer)
        return answer

    return register
