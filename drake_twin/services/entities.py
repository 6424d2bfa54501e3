"""What the services of all simulators share: entities, their poses, and robots from texts."""

import re
from itertools import count
from math import fsum, isfinite, sqrt
from pathlib import Path
from typing import Any

from drake_twin.description.lasting_files import lasting_file
from drake_twin.description.robot_model import as_expanded
from drake_twin.errors import InputError
from drake_twin.scenario import Robot
from drake_twin.scenario.names import name_in_twin, problem_of_name
from drake_twin.services.registry import Fields
from drake_twin.twin.twin import Twin

MOST_TEXT = 1 << 20  # characters of a description
WORLD_NAMES = ("", "world", "map", "/map")


class PoseError(InputError):
    """Raised for an invalid pose."""


def entity_names(twin: Twin) -> list[str]:
    """Return the names of all robots and models of the world."""
    return list(twin.latest("/model_states").name)


def free_name(twin: Twin, name: str) -> str:
    """Return a name that no entity has: the name itself, or one with a number after it."""
    taken = set(entity_names(twin))
    return name if name not in taken else next(f"{name}_{i}" for i in count(1) if f"{name}_{i}" not in taken)


def spawn(twin: Twin, name: str, *, uri: str = "", text: str = "", namespace: str = "", pose: Any, frame: str) -> str:
    """Add a robot to a running twin.

    Args:
        twin: The twin.
        name: The robot's name; empty for a free one that begins with the name that the description gives.
        uri: The address of its file; or
        text: its URDF or SDF, which xacro does not expand: a message must not run code.
        namespace: The namespace of its topics; its name by default.
        pose: A ``geometry_msgs/msg/Pose``.
        frame: The entity in whose frame the pose is.

    Returns:
        The robot's name.

    Raises:
        InputError: If the robot cannot be added.
    """
    if not uri and not text:
        raise InputError("neither a file nor a description is given")
    if len(text) > MOST_TEXT:
        raise InputError(f"the description has more than {MOST_TEXT} characters")
    if not name and (own := re.search(r"""<(?:robot|model)\b[^>]*\sname\s*=\s*["']([^"']+)""", text)):
        name = free_name(twin, name_in_twin(own[1]))
    if (what := problem_of_name(name)) is not None:  # before a file has the name
        raise InputError(what)
    if frame not in WORLD_NAMES:
        raise PoseError(f"a robot's start pose is in the world, not in {frame!r}")
    xyz, wxyz = pose_of(pose)
    kind = "sdf" if re.search(r"<sdf\b", text) else "urdf"
    model = uri.removeprefix("file://") or str(lasting_file(f"{name}.{kind}", as_expanded(text)))
    twin.entities.spawn(Robot(name, model, xyz=xyz, rpy=_rpy(wxyz), namespace=namespace or None))
    return name


def pose_of(pose: Any) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """Return position (m) and quaternion w, x, y, z of a message; the null quaternion rotates nothing.

    Raises:
        PoseError: If a number is not finite.
    """
    at, turn = pose.position, pose.orientation
    xyz, wxyz = (at.x, at.y, at.z), (turn.w, turn.x, turn.y, turn.z)
    if not all(map(isfinite, (*xyz, *wxyz))):
        raise PoseError("the pose has a number that is not finite")
    length = sqrt(fsum(part * part for part in wxyz))
    w, x, y, z = (part / length for part in wxyz) if 0 < length < float("inf") else (1.0, 0.0, 0.0, 0.0)
    return xyz, (w, x, y, z)


def state_fields(twin: Twin, entity: str, reference: str = "") -> tuple[Fields, Fields]:
    """Return the pose and the twist of an entity as fields of messages.

    Raises:
        InputError: If an entity does not exist.
    """
    state = twin.entities.state(entity, "world" if reference in WORLD_NAMES else reference)
    pose = {"position": _xyz(state.position), "orientation": dict(zip("wxyz", state.orientation, strict=True))}
    return pose, {"linear": _xyz(state.linear), "angular": _xyz(state.angular)}


def set_state(twin: Twin, entity: str, *, pose: Any = None, twist: Any = None, reference: str = "") -> None:
    """Move an entity at once.

    Raises:
        InputError: If an entity does not exist or cannot be moved, or a number is not finite.
    """
    values: dict[str, Any] = {}
    if pose is not None:
        values["position"], values["orientation"] = pose_of(pose)
    if twist is not None:
        for name in ("linear", "angular"):
            vector = getattr(twist, name)
            values[name] = (vector.x, vector.y, vector.z)
    twin.entities.set_state(entity, **values, reference="world" if reference in WORLD_NAMES else reference)


def world_name(twin: Twin) -> str:
    """Return the name of the world as Gazebo's topics have it: its file's, or ``default``."""
    file = twin.scenario.world.file
    return "default" if file is None else Path(file).name.partition(".")[0]


def _xyz(vector: tuple[float, float, float]) -> Fields:
    return dict(zip("xyz", vector, strict=True))


def _rpy(wxyz: tuple[float, float, float, float]) -> tuple[float, float, float]:
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.math import RollPitchYaw

    roll, pitch, yaw = map(float, RollPitchYaw(Quaternion(wxyz)).vector())
    return roll, pitch, yaw
