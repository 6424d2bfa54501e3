"""A push as plain data: a force that acts on a link for a while."""

from collections.abc import Iterator

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Vector3
from drake_twin.saved import saved
from drake_twin.typed_data import ValuePath

PUSH_DURATION = 0.1  # s, unless another one is given


@saved("Push")
@dataclass(frozen=True)
class Push:
    """A force on a link. Either `force` or `strength` is given.

    Attributes:
        entity: A link as in `Twin.entities.apply_wrench`, for example ``robot_1::base_link``; or a robot or a model of
            the world, for its root link. The prefix of a link with the robot's name may be left out.
        time: When it begins (simulated s).
        force: The force in the world's axes (N).
        strength: The size of a horizontal force (N), whose direction is drawn from the scenario's seed.
        duration: How long it acts (s); one physics step at least.
        at: The point of the link at which it acts, in the link's frame (m); by default the link's center of mass, as
            its file has it.
    """

    entity: str
    time: float
    force: Vector3 | None = None
    strength: float | None = None
    duration: float = PUSH_DURATION
    at: Vector3 | None = None


def problems_of_push(push: Push, latest: float) -> Iterator[tuple[ValuePath, str]]:
    """Yield what is wrong with a push, with the path of the value.

    Args:
        push: The push.
        latest: The latest time (s).
    """
    if not push.entity:
        yield ("entity",), "a push needs a robot, a link or a model of the world"
    if (push.force is None) == (push.strength is None):
        yield ("force",), "a push has either a force (three numbers) or a strength, whose direction is drawn"
    if push.strength is not None and not push.strength > 0:
        yield ("strength",), f"{push.strength:g} N is not above zero"
    if not 0 <= push.time <= latest:
        yield ("time",), f"{push.time:g} s is not a time from zero to {latest:g} s"
    if not 0 <= push.duration <= latest:
        yield ("duration",), f"{push.duration:g} s is not a duration from zero to {latest:g} s"
