"""Requests to the services of gz-sim's world, as plain data: to move, add and remove models, to pause and reset."""

import re
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

from drake_twin.dataclass import dataclass
from drake_twin.description.breadcrumbs import Deploy
from drake_twin.description.protobuf_text import Fields, Word, read_fields
from drake_twin.description.touches import EnableTouch
from drake_twin.errors import did_you_mean
from drake_twin.values import is_number

_SERVICE = re.compile(r"/world/([^/]+)/(\w+)")
_ENABLE = "/enable"
_MODEL = (0, 2, "NONE", "MODEL")


class UnknownRequestError(Exception):
    """Raised for a service, a type or a field that the twin does not know; the message says which."""


@dataclass(frozen=True)
class ModelPose:
    """A pose of a model's frame in the world: position (m) and quaternion w, x, y, z."""

    model: str
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]


@dataclass(frozen=True)
class SetPoses:
    """Moves models at once; they keep their velocities."""

    poses: tuple[ModelPose, ...]


@dataclass(frozen=True)
class Create:
    """Adds a model.

    Attributes:
        pose: Its name and its pose; without a name it has that of its file.
        file: The address of its file; or
        text: its SDF.
        may_be_renamed: Whether it gets another name where its own is taken.
    """

    pose: ModelPose
    file: str = ""
    text: str = ""
    may_be_renamed: bool = False


@dataclass(frozen=True)
class Remove:
    """Removes a model."""

    model: str


@dataclass(frozen=True)
class ControlWorld:
    """Pauses the world, or lets time continue, after a reset if wanted."""

    pauses: bool
    resets: bool


@dataclass(frozen=True)
class FixModel:
    """Fixes a model that was dropped to the world, where it is."""

    model: str


GzRequest: TypeAlias = SetPoses | Create | Remove | ControlWorld | Deploy | FixModel | EnableTouch


def read_request(service: str, kind: str, text: str) -> tuple[str, GzRequest]:
    """Read a request.

    Args:
        service: The service's name, ``/world/NAME/set_pose``.
        kind: The request's type.
        text: The request in the text format of Protocol Buffers.

    Returns:
        The world's name, which a TouchPlugin's service has not, and the request.

    Raises:
        UnknownRequestError: If the twin has no such service, or it takes another type or other fields.
        ValueError: If the text is not a request of the type.
    """
    if service.endswith(_ENABLE) and re.split(r"[./]", kind)[-1] == "Boolean":
        fields = read_fields(text)
        _check(fields, "Boolean", ("data",))
        return "", EnableTouch(f"/{service.removesuffix(_ENABLE).strip('/')}", _flag(fields, "data"))
    match = _SERVICE.fullmatch(service)
    if match is None or match[2] not in _SERVICES:
        raise UnknownRequestError(f"the twin has no service {service}")
    own, read = _SERVICES[match[2]]
    if re.split(r"[./]", kind)[-1] != own:
        raise UnknownRequestError(f"{service} takes a gz.msgs.{own}, and not a {kind}")
    return match[1], read(read_fields(text))


def _set_pose(fields: Fields) -> GzRequest:
    return SetPoses((_model_pose(fields),))


def _set_pose_vector(fields: Fields) -> GzRequest:
    _check(fields, "Pose_V", ("header", "pose"))
    return SetPoses(tuple(_model_pose(_message(item, "pose")) for item in fields.get("pose", ())))


def _create(fields: Fields) -> GzRequest:
    _check(fields, "EntityFactory", ("sdf", "sdf_filename", "pose", "name", "allow_renaming"))
    name, text, file = (_text(fields, field) for field in ("name", "sdf", "sdf_filename"))
    if not text and not file:
        raise ValueError("neither sdf nor sdf_filename is given")
    pose = _model_pose(_one(fields, "pose", {}), name=name)
    return Create(pose, file, text, _flag(fields, "allow_renaming"))


def _remove(fields: Fields) -> GzRequest:
    _check(fields, "Entity", ("name", "type"))
    if fields.get("type", [0])[-1] not in _MODEL or not (name := _text(fields, "name")):
        raise ValueError("only models can be removed, and by their names")
    return Remove(name)


def _control(fields: Fields) -> GzRequest:
    _check(fields, "WorldControl", ("pause", "reset"))
    reset = _message(_one(fields, "reset", {}), "reset")
    _check(reset, "WorldReset", ("all",))
    return ControlWorld(_flag(fields, "pause"), _flag(reset, "all"))


_SERVICES: dict[str, tuple[str, Callable[[Fields], GzRequest]]] = {
    "set_pose": ("Pose", _set_pose),
    "set_pose_vector": ("Pose_V", _set_pose_vector),
    "create": ("EntityFactory", _create),
    "remove": ("Entity", _remove),
    "control": ("WorldControl", _control),
}


def _model_pose(fields: Any, name: str | None = None) -> ModelPose:
    fields = _message(fields, "pose")
    _check(fields, "Pose", ("header", "name", "position", "orientation"))
    if name is None and not (name := _text(fields, "name")):
        raise ValueError("the pose has no name of a model")
    position = _message(_one(fields, "position", {}), "position")
    orientation = _message(_one(fields, "orientation", {}), "orientation")
    _check(position, "Vector3d", ("header", *"xyz"))
    _check(orientation, "Quaternion", ("header", *"xyzw"))
    x, y, z = (_number(position, axis) for axis in "xyz")
    turn = [_number(orientation, axis) for axis in "wxyz"]
    length = sum(part * part for part in turn) ** 0.5
    qw, qx, qy, qz = (part / length for part in turn) if length else (1.0, 0.0, 0.0, 0.0)
    return ModelPose(name, (x, y, z), (qw, qx, qy, qz))


def _check(fields: Fields, kind: str, known: Sequence[str]) -> None:
    for name in fields:
        if name not in known:
            what = f"the twin knows no field {name!r} of gz.msgs.{kind}{did_you_mean(name, known)}"
            raise UnknownRequestError(what)


def _one(fields: Fields, name: str, default: Any) -> Any:
    values = fields.get(name, [default])
    if len(values) != 1:
        raise ValueError(f"the field {name!r} is given {len(values)} times")
    return values[0]


def _message(value: Any, name: str) -> Fields:
    if not isinstance(value, dict):
        raise ValueError(f"{name!r} is {value!r}, which is not a message in braces")
    return value


def _text(fields: Fields, name: str) -> str:
    value = _one(fields, name, "")
    if not isinstance(value, str) or isinstance(value, Word):
        raise ValueError(f"{name!r} is {value!r}, which is not a text")
    return value


def _number(fields: Fields, name: str) -> float:
    value = _one(fields, name, 0.0)
    if not is_number(value):
        raise ValueError(f"{name!r} is {value!r}, which is not a finite number")
    return float(value)


def _flag(fields: Fields, name: str) -> bool:
    value = _one(fields, name, False)
    if value not in ("true", "false", 0, 1, True, False):
        raise ValueError(f"{name!r} is {value!r}, which is neither true nor false")
    return value in ("true", 1, True)
