"""Belts and vehicles on tracks of gz-sim's systems, as SDF, and how mechanics says that such a vehicle turns."""

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import fsolve

from drake_twin import Twin, TwinBuilder
from drake_twin.description.surface_velocity import NEEDS, has_surface_velocity
from drake_twin.findings import Kind
from drake_twin.messages.interface_types import make
from drake_twin.scenario import CENIC, World

G = 9.81
LENGTH, WIDTH, HEIGHT = 0.6, 0.1, 0.15  # of a track (m)
SEPARATION = 0.4  # m
FRICTION = 0.5
STEPS = (0.001, 0.01, CENIC)
TRACK = "gz-sim-track-controller-system"


def moving(test: Callable[..., None]) -> Callable[..., None]:
    """A test of motion; with a Drake without moving surfaces it checks what is said of that."""

    @wraps(test)
    def stands(tmp_path: Path, step: float | str = 0.001, **_: Any) -> None:
        stands_still(tank_twin(tmp_path, step))

    return test if has_surface_velocity() else stands


def stands_still(twin: Twin) -> None:
    """Checks that a vehicle loads without its tracks, that one finding says why, and that it stands."""
    (finding,) = (item for item in twin.built.findings if item.kind is Kind.NOT_STARTED)
    assert finding.what == f"Gazebo plugin track_controller ({TRACK}): {NEEDS}"
    assert (Path(finding.file).name, finding.lines) == ("tank.sdf", (5,))
    assert not [topic for topic in twin.built.commanded if "cmd_vel" in topic]
    twin.advance_to(0.2)
    assert np.abs(twin.entities.state("tank").linear).max() < 1e-4


def plugin(library: str, name: str, body: str) -> str:
    """SDF of one of gz-sim's systems."""
    return f'<plugin filename="gz-sim-{library}-system" name="gz::sim::systems::{name}">{body}</plugin>'


def track(link: str, more: str = "") -> str:
    """SDF of a TrackController."""
    return plugin("track-controller", "TrackController", f"<link>{link}</link>{more}")


def tracked_vehicle(more: str = "", sides: str | None = None) -> str:
    """SDF of a TrackedVehicle on the tracks ``left`` and ``right``."""
    own = "".join(f"<{side}_track><link>{side}</link></{side}_track>" for side in ("left", "right"))
    body = f"{own if sides is None else sides}<tracks_separation>{SEPARATION}</tracks_separation>{more}"
    return plugin("tracked-vehicle", "TrackedVehicle", body)


def solid(mass: float, *size: float) -> str:
    """SDF of the inertia of a box."""
    x, y, z = np.array(size) ** 2
    moments = dict(zip("xyz", mass / 12 * np.array((y + z, x + z, x + y)), strict=True))
    own = "".join(f"<i{axis}{axis}>{value}</i{axis}{axis}>" for axis, value in moments.items())
    return f"<inertial><mass>{mass}</mass><inertia>{own}<ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>"


def shape(geometry: str, friction: float = FRICTION) -> str:
    """SDF of a collision shape."""
    own = f"<friction><ode><mu>{friction}</mu><mu2>{friction}</mu2></ode></friction>"
    return f'<collision name="c"><geometry>{geometry}</geometry><surface>{own}</surface></collision>'


def box(*size: float) -> str:
    """SDF of a box."""
    return f"<box><size>{' '.join(map(str, size))}</size></box>"


def tank(plugins: str | None = None, joint: str = "fixed") -> str:
    """SDF of a vehicle of 20 kg whose center of mass is in the middle of its tracks, 5 cm above the ground."""
    low = HEIGHT / 2 - 0.05
    body = f'<link name="body"><pose>0 0 {HEIGHT / 2} 0 0 0</pose>{solid(10, 0.5, 0.2, 0.1)}</link>'
    body = body.replace("<inertial>", f"<inertial><pose>0 0 {-low} 0 0 0</pose>")
    parts = [body]
    for side, y in (("left", SEPARATION / 2), ("right", -SEPARATION / 2)):
        own = solid(5, LENGTH, WIDTH, HEIGHT).replace("<inertial>", f"<inertial><pose>0 0 {-low} 0 0 0</pose>")
        own += shape(box(LENGTH, WIDTH, HEIGHT))
        parts.append(f'<link name="{side}"><pose>0 {y} {HEIGHT / 2} 0 0 0</pose>{own}</link>')
        parts.append(f'<joint name="{side}_joint" type="{joint}"><parent>body</parent><child>{side}</child></joint>')
    if plugins is None:
        plugins = f"{track('left')}\n{track('right')}\n{tracked_vehicle()}"
    return f'<sdf version="1.9"><model name="tank">\n\n{"".join(parts)}\n\n{plugins}\n</model></sdf>'


def built(folder: Path, step: float | str, robots: dict[str, tuple[Any, ...]], **world: Any) -> Twin:
    """A twin with robots: name → (their SDF, xyz, rpy)."""
    engine = {"engine": CENIC} if step == CENIC else {"time_step": step}
    builder = TwinBuilder(world=World(**{"gravity": (0, 0, -G)} | world), **engine)
    for name, (text, xyz, *rpy) in robots.items():
        (folder / f"{name}.sdf").write_text(text)
        builder.robot(name, folder / f"{name}.sdf", xyz=xyz, rpy=rpy[0] if rpy else (0, 0, 0))
    return builder.build()


def tank_twin(
    folder: Path, step: float | str = 0.001, pose: tuple[tuple[float, ...], ...] = ((0, 0, 1e-4),), **world: Any
) -> Twin:
    """A twin with a vehicle, which stands on the ground, forwards along x, if nothing else is said."""
    return built(folder, step, {"tank": (tank(), *pose)}, **world)


def number(value: float) -> Any:
    """A message with a number."""
    return make("std_msgs/msg/Float64", {"data": float(value)})


def twist(x: float, z: float) -> Any:
    """A message with a velocity of a base."""
    return make("geometry_msgs/msg/Twist", {"linear": {"x": x, "y": 0.0, "z": 0.0}, "angular": {"z": z}})


def steady_turn(left: float, right: float, height: float = 0.05) -> tuple[float, float]:
    """How fast the vehicle moves and turns at last (m/s, rad/s), with its tracks at two speeds (m/s).

    Coulomb's friction is against the slip at each place of the tracks' faces. Its sum turns the velocity and has no
    moment about the center of mass. The pressure there is that of an elastic ground: it rises towards the outer side,
    as the friction acts below the center of mass.

    Args:
        left: The speed of the left track.
        right: The speed of the right track.
        height: The height of the center of mass (m).
    """
    count = 40
    x = (np.arange(6 * count) + 0.5) / (6 * count) * LENGTH - LENGTH / 2
    y = (np.arange(count) + 0.5) / count * WIDTH - WIDTH / 2
    x, y = (values.ravel() for values in np.meshgrid(x, y, indexing="ij"))
    belt = np.repeat((left, right), len(x))
    x, y = np.tile(x, 2), np.concatenate([y + SEPARATION / 2, y - SEPARATION / 2])

    def unbalanced(values: np.ndarray) -> list[float]:
        along, across, turning = values
        acceleration = np.array((-turning * across, turning * along))
        pressure = G - height * (acceleration[0] * x / np.mean(x**2) + acceleration[1] * y / np.mean(y**2))
        slip = np.array((along - turning * y - belt, across + turning * x))
        force = -FRICTION * pressure * slip / np.maximum(np.hypot(*slip), 1e-12)
        return [*(force.mean(axis=1) - acceleration), float((x * force[1] - y * force[0]).mean())]

    along, across, turning = fsolve(unbalanced, ((left + right) / 2, 0.0, 0.6 * (right - left) / SEPARATION))
    return float(np.hypot(along, across)), float(turning)
