"""A recording of a twin as a log: its commands, and what the twin measured, which repeating it tells."""

from collections.abc import Iterator, Sequence
from typing import Any

from drake_twin.calibration.log import Log, made_log, series_of
from drake_twin.calibration.measured import NUMBERS
from drake_twin.errors import InputError
from drake_twin.scenario import Command
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED, Endpoint
from drake_twin.twin.recording import Recording
from drake_twin.twin.twin import Twin


def recorded_log(recording: Recording, endpoints: Sequence[Endpoint], name: str = "the recording") -> Log:
    """Return what a recording's twin was commanded, and what it measured.

    Args:
        recording: The recording, from its twin's start on.
        endpoints: The topics of the twin that is to be fitted.
        name: The recording's file.

    Raises:
        InputError: If something else than commands was recorded, or the twins have nothing in common.
    """
    others = sorted({call.name for call in recording.calls if call.name not in ("publish", "record")})
    if others:
        raise InputError(f"only commands can be repeated with other values; it also has {', '.join(others)}", file=name)
    scenario = ScenarioFile(recording.start.scenario, name).scenario
    published = {item.name: item.type for item in endpoints if item.kind == PUBLISHED and item.type in NUMBERS}
    commanded = {item.name for item in endpoints if item.kind == COMMANDED}
    received: dict[str, list[tuple[float, Any]]] = {}
    with Twin(scenario) as twin:
        twin.restore(recording.start)
        if twin.time > 0:
            raise InputError(f"it begins at {twin.time:g} s: record from the twin's start", file=name)
        for topic, kind in published.items():
            if twin.graph.topics().get(topic) == kind:
                own = received.setdefault(topic, [])
                twin.subscribe(topic, lambda message, own=own: own.append((twin.time, message)))  # type: ignore[misc]
        for call in recording.calls:
            twin.advance_to(max(call.time, twin.time))
            if not call.is_refused:
                twin.publish(*call.arguments, **call.named)
        twin.advance_to(max(recording.end, twin.time))
    commands = [
        (call.time, *_command(*call.arguments, **call.named)) for call in recording.calls if not call.is_refused
    ]
    commands += [item for command in scenario.commands for item in _repeated(command, recording.end)]
    notes = [f"{topic} is not used" for _, topic, _ in commands if topic not in commanded]
    measured = []
    for topic, own in received.items():
        rows = [NUMBERS[published[topic]](message) for _, message in own]
        measured.append((topic, topic, series_of(topic, [time for time, _ in own], rows, notes)))
    return made_log(name, [item for item in commands if item[1] in commanded], measured, tuple(dict.fromkeys(notes)))


def _command(topic: str, data: Any) -> tuple[str, Any]:
    return topic, data


def _repeated(command: Command, end: float) -> Iterator[tuple[float, str, Any]]:
    """Yield a scenario's command as often as it was published."""
    count = 1 if command.period is None else int((end - command.time) / command.period) + 1
    for index in range(count):
        time = command.time + index * (command.period or 0.0)
        if time <= end:
            yield time, command.topic, command.data
