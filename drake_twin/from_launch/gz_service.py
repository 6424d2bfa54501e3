"""Spawning by ``gz service -s /world/NAME/create --req 'sdf_filename: "robot.sdf", name: "rover"'``."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from drake_twin.from_launch.command_line import CommandLine, command_line
from drake_twin.from_launch.static_frames import roll_pitch_yaw
from drake_twin.ros2.launched import NODE, LaunchedProcess

_CREATE = re.compile(r"/world/[^/]+/create")
# A token of protobuf's text format with what separates it from the next: a quoted text, a bracket or a word.
_QUOTED = r"""(?P<quote>["'])(?P<text>(?:\\.|(?!(?P=quote)).)*)(?P=quote)"""
_TOKEN = re.compile(rf"\s*(?:{_QUOTED}|(?P<word>[{{}}]|[\w.+-]+))\s*[:,;]?", re.DOTALL)

_OPTIONS = {"name": "-name", "sdf_filename": "-file", "sdf": "-string"}


def as_create(process: LaunchedProcess, words: Sequence[str]) -> LaunchedProcess | None:
    """Return the ``ros_gz_sim create`` node that does what a call of Gazebo's service does.

    What is not an ``EntityFactory`` in protobuf's text format becomes a node without a description, which is refused.

    Args:
        process: The process.
        words: Its command line: ``gz service …`` or ``ign service …``.

    Returns:
        The node; None for any other command.
    """
    if [*words[:2]] not in (["gz", "service"], ["ign", "service"]):
        return None
    line = command_line(process, words[2:], verbatim=("req", "r"))
    if not _CREATE.fullmatch(line.text("service", "s") or ""):
        return None
    found = _TOKEN.finditer(line.text("req", "r") or "")
    tokens = [match["word"] or re.sub(r"\\(.)", r"\1", match["text"]) for match in found]
    arguments = tuple(_arguments(line, _message(iter(tokens))))
    return replace(process, kind=NODE, package="ros_gz_sim", executable="create", arguments=arguments)


def _message(tokens: Iterator[str]) -> dict[str, Any]:
    """Read fields up to the closing bracket: name → text, or the fields of a message."""
    fields: dict[str, Any] = {}
    for name in tokens:
        if name == "}":
            break
        value = next(tokens, "")
        fields[name] = _message(tokens) if value == "{" else value
    return fields


def _arguments(line: CommandLine, fields: Mapping[str, Any]) -> Iterator[str]:
    """Yield the arguments of ``create`` for an EntityFactory."""
    for field, option in _OPTIONS.items():
        if isinstance(text := fields.get(field), str):
            yield from (option, text)
    pose = _part(fields, "pose")
    position, turned = _part(pose, "position"), _part(pose, "orientation")
    for axis in "xyz":
        if axis in position:
            yield from (f"-{axis}", str(position[axis]))
    try:
        quaternion = [float(turned.get(axis, 0.0)) for axis in "xyzw"]
    except (TypeError, ValueError):
        yield from ("-Y", str(turned))  # which create refuses
    else:
        if any(quaternion):
            for option, angle in zip(("-R", "-P", "-Y"), roll_pitch_yaw(line, *quaternion), strict=True):
                yield from (option, repr(angle))
    if fields.get("allow_renaming") in ("true", "1"):
        yield "-allow_renaming"


def _part(fields: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    part = fields.get(name)
    return part if isinstance(part, Mapping) else {}
