"""Readers and writers of DDS with ROS's quality of service, over the bytes of messages."""

import contextlib
from collections.abc import Callable
from typing import Any

from drake_twin.wires.rmw_dds_format import sample_type

MOST_SAMPLES = 100  # that are taken from a reader at once
_PATIENCE = 1  # ms for readers to make room for a message; then it is lost


def matched(handles: Callable[[], list[int]]) -> list[int]:
    """Return the handles of the other ends, from a method of a reader or writer.

    CycloneDDS's Python counts them first and raises an IndexError where one more has come when it reads them.
    """
    while True:
        with contextlib.suppress(IndexError):
            return handles()


def quality(
    data: bytes,
    *,
    latched: bool = False,
    depth: int | None = 10,
    is_best_effort: bool = False,
    lifespan: float | None = None,
    deadline: float | None = None,
    is_manual: bool = False,
    lease: float | None = None,
) -> Any:
    """Return the quality of service as ROS has it: reliable by default, and kept for late joiners if latched.

    Args:
        data: The user data of the reader or writer.
        latched: Whether late joiners get what was sent before.
        depth: How many messages are kept; None for all.
        is_best_effort: Whether messages may be lost.
        lifespan: How long messages are kept (s); None for always.
        deadline: The longest time between messages (s); None for any.
        is_manual: Whether a writer says itself that it is alive.
        lease: The time in which it has to (s); None for any.
    """
    from cyclonedds.core import Policy, Qos
    from cyclonedds.util import duration

    more: list[Any] = []
    if lifespan is not None:
        more.append(Policy.Lifespan(duration(seconds=lifespan)))
    if deadline is not None:
        more.append(Policy.Deadline(duration(seconds=deadline)))
    if is_manual or lease is not None:
        alive = Policy.Liveliness.ManualByTopic if is_manual else Policy.Liveliness.Automatic
        more.append(alive(duration(infinite=True) if lease is None else duration(seconds=lease)))
    if latched and depth is not None:  # it counts for late joiners, not the history
        more.append(Policy.DurabilityService(0, Policy.History.KeepLast(depth), -1, -1, -1))
    return Qos(
        *more,
        Policy.Reliability.BestEffort
        if is_best_effort
        else Policy.Reliability.Reliable(max_blocking_time=duration(milliseconds=_PATIENCE)),
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.History.KeepAll if depth is None else Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True),
        Policy.WriterDataLifecycle(autodispose=False),
        Policy.Userdata(data),
        Policy.IgnoreLocal.Participant,  # the seam knows what the twin has itself
    )


def writer(participant: Any, name: str, ros_type: str, qos: Any, *, has_header: bool = False) -> Any:
    """Return a writer of a topic's bytes."""
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    return DataWriter(participant, Topic(participant, name, sample_type(ros_type, has_header=has_header)), qos)


def reader(participant: Any, name: str, ros_type: str, qos: Any, *, has_header: bool = False) -> tuple[Any, Any]:
    """Return a reader of a topic's bytes, and the condition that something has come."""
    from cyclonedds.core import ReadCondition, SampleState
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic

    made = DataReader(participant, Topic(participant, name, sample_type(ros_type, has_header=has_header)), qos)
    return made, ReadCondition(made, SampleState.NotRead)
