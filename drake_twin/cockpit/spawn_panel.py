"""The dialog that spawns robots: what there is to spawn, a file's arguments, and the spawn with its refusal."""

import contextlib
import json
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from drake_twin.cockpit.panel import panel
from drake_twin.cockpit.protocol import read_as
from drake_twin.cockpit.robot_box import RobotBox
from drake_twin.cockpit.robot_files import robot_files
from drake_twin.cockpit.robot_picture import RobotPicture
from drake_twin.cockpit.xacro_trial import XacroTrial
from drake_twin.dataclass import dataclass
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Vector3
from drake_twin.description.robot_model import is_xacro_text, read_robot_file
from drake_twin.description.xacro_file import xacro_arguments
from drake_twin.diagram.footprint import Footprint, footprint, height_on_ground
from drake_twin.diagram.free_place import area_of, free_place, taken_areas
from drake_twin.errors import InputError, TwinError
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.scenario import Robot
from drake_twin.shared_viewer.shared_scene import scene_graph_of
from drake_twin.twin.twin import Twin

_PATIENCE = 60  # snapshots, about 4 s, for which a dialog is given data without asking again
_REPEATS = 4  # snapshots with the same picture: a slow browser skips some


@dataclass(frozen=True)
class Look:
    """A tab shows the dialog; repeated about five times a second.

    Attributes:
        file: The file that is typed or chosen.
    """

    file: str


@dataclass(frozen=True)
class Spawn:
    """Spawn a robot.

    Attributes:
        key: Names the request in its outcome.
        file: Its file.
        name: Its name.
        xyz: Its position (m).
        rpy: Its orientation (rad).
        stands: Whether z is the height of the ground that it stands on.
        beside: Whether it goes to the nearest free place beside what is there; x and y of the position are ignored.
        arguments: Its xacro arguments, as a JSON object of texts.
        controllers: A parameters file of its controllers; empty for the file's own.
    """

    key: str
    file: str
    name: str
    xyz: Vector3
    rpy: Vector3
    stands: bool
    beside: bool
    arguments: str
    controllers: str


@dataclass(frozen=True)
class Preview:
    """Draw a robot.

    Attributes:
        key: Names the request in its picture.
        file: Its file.
        arguments: Its xacro arguments, as a JSON object of texts.
    """

    key: str
    file: str
    arguments: str


@dataclass(frozen=True)
class Measure:
    """Find how large a robot is, and a free place for it.

    Attributes:
        key: Names the request in its answer.
        file: Its file.
        arguments: Its xacro arguments, as a JSON object of texts.
    """

    key: str
    file: str
    arguments: str


_REQUESTS = {kind.__name__: kind for kind in (Look, Spawn, Preview, Measure)}


@panel("spawn", Path(__file__).with_name("static") / "spawn_panel.js")
class SpawnPanel:
    """What the dialog shows, and what it asks for."""

    def __init__(self, twin: Twin):
        self._twin = twin
        self._left = 0  # snapshots for which a tab looks
        self._file = ""
        self._arguments: dict[str, str] = {}
        self._files: list[str] | None = None
        self._search: threading.Thread | None = None
        self._trial: tuple[XacroTrial | None, Spawn, Robot] | None = None
        self._outcome = {"key": "", "status": "", "message": ""}
        self._drawing: tuple[RobotPicture, str] | None = None
        self._measuring: tuple[RobotBox, str] | None = None
        self._box: dict[str, Any] | None = None
        self._pictures: deque[dict[str, str]] = deque()  # once for each snapshot that a picture is still sent with

    def state(self) -> dict[str, Any] | None:
        """Return the robots to choose from, the file's arguments, and the last spawn; None while nobody looks."""
        self._left = max(0, self._left - 1)
        if not self._left:
            self._cancel()
            return None
        here = dict.fromkeys(robot.model for robot in self._twin.scenario.robots)
        return {
            "here": list(here),
            "files": self._files,
            "file": self._file,
            "arguments": self._arguments,
            "box": self._box,
            "preview": self._pictures.popleft() if self._pictures else None,
            **self._outcome,
        }

    def watch(self, is_watched: bool) -> None:
        """Draw nothing while no browser is connected."""
        if not is_watched:
            self._cancel()

    def ask(self, data: Any) -> None:
        """Do what a tab asks; what is wrong with a spawn is part of the state.

        Raises:
            InputError: If the request is not one.
        """
        request = read_as(_REQUESTS, data)
        match request:
            case Look(file):
                self._look(file)
            case Spawn():
                self._left = _PATIENCE
                self._try(lambda: self._begin(request), request.key)
            case Preview(key, file, arguments):
                self._left = _PATIENCE
                self._cancel_drawing()
                try:
                    self._drawing = RobotPicture(file, _texts(arguments), self._twin.scenario.package_paths), key
                except InputError as error:
                    self._show(key, "", str(error))
            case Measure(key, file, arguments):
                self._left = _PATIENCE
                self._cancel_measuring()
                with contextlib.suppress(InputError):  # said when it is spawned
                    self._measuring = RobotBox(file, _texts(arguments), self._twin.scenario.package_paths), key
            case _:
                raise InputError(f"unknown request {data!r} of the spawn dialog")

    def _look(self, file: str) -> None:
        self._left = _PATIENCE
        if self._search is None:
            packages = self._packages()
            self._search = threading.Thread(target=self._find, args=(packages,), name="robot files", daemon=True)
            self._search.start()
        if file != self._file:
            self._file, self._arguments = file, {}
            with contextlib.suppress(InputError):  # said when it is spawned
                self._arguments = self._declared(self._packages().resolve(file))
        if self._drawing is not None and self._drawing[0].is_done():
            drawn, key = self._drawing
            self._drawing = None
            self._show(key, drawn.output.decode().strip(), drawn.problem or "")
        if self._measuring is not None and self._measuring[0].is_done():
            measured, key = self._measuring
            self._measuring = None
            self._box = {"key": key, "problem": measured.problem or ""}
            if not measured.problem:
                lower, upper = json.loads(measured.output)
                place = self._free_place(Footprint(tuple(lower), tuple(upper)), 0.0)
                self._box |= {"lower": lower, "upper": upper, "place": place}
        if self._trial is not None and (self._trial[0] is None or self._trial[0].is_done()):
            trial, request, robot = self._trial
            self._trial = None
            self._try(lambda: self._end(trial, request, robot), request.key)

    def _show(self, key: str, picture: str, problem: str) -> None:
        self._pictures.extend([{"key": key, "picture": picture, "problem": problem}] * _REPEATS)

    def _free_place(self, box: Footprint, yaw: float) -> tuple[float, float]:
        """Return the free place nearest to the last robot."""
        twin = self._twin
        scene_graph = scene_graph_of(twin)
        query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(twin.context))
        robots = [twin.robot_state(name, with_efforts=False).base_pose for name in twin.robots]
        places = [(pose[0], pose[1]) for pose in robots] or [(0.0, 0.0)]
        near = round(places[-1][0], 1), round(places[-1][1], 1)
        return free_place(area_of(box, yaw), taken_areas(query, places), near)

    def _cancel(self) -> None:
        self._cancel_drawing()
        self._cancel_measuring()

    def _cancel_measuring(self) -> None:
        if self._measuring is not None:
            self._measuring[0].cancel()
        self._measuring = None

    def _cancel_drawing(self) -> None:
        if self._drawing is not None:
            self._drawing[0].cancel()
        self._drawing = None

    def _declared(self, file: Path) -> dict[str, str]:
        return xacro_arguments(file, self._packages()) if file.is_file() else {}

    def _find(self, packages: PackageIndex) -> None:
        self._files = list(robot_files(packages))

    def _packages(self) -> PackageIndex:
        return PackageIndex(self._twin.scenario.package_paths)

    def _begin(self, request: Spawn) -> None:
        """Expand the file in a process of its own, if it is a xacro file."""
        if self._trial is not None:
            raise InputError("another robot is being spawned")
        controllers = (request.controllers,) if request.controllers else ()
        arguments = _texts(request.arguments)
        robot = Robot(
            name=request.name,
            model=request.file,
            xyz=request.xyz,
            rpy=request.rpy,
            xacro_args=arguments,
            controllers=controllers,
        )
        file = self._packages().resolve(robot.model)
        given = {"robot_name": robot.name} if "robot_name" in self._declared(file) else {}
        trial = None
        if is_xacro_text(read_robot_file(file)):
            trial = XacroTrial(file, {**given, **arguments}, self._twin.scenario.package_paths)
        self._trial = trial, request, robot
        self._outcome = {"key": request.key, "status": "reading", "message": ""}

    def _end(self, trial: XacroTrial | None, request: Spawn, robot: Robot) -> None:
        if trial is not None and trial.problem is not None:
            raise InputError(trial.problem)
        plan = None
        if request.stands or request.beside:
            plan = plan_robot(robot, self._packages())
            x, y, z = robot.xyz
            if request.beside:
                x, y = self._free_place(footprint(plan), robot.rpy[2])
            robot = replace(robot, xyz=(x, y, z + (height_on_ground(plan) if request.stands else 0.0)))
            plan = replace(plan, robot=robot)
        self._twin.entities.spawn(robot, plan=plan)
        self._outcome = {"key": request.key, "status": "done", "message": ""}

    def _try(self, do: Callable[[], None], key: str) -> None:
        try:
            do()
        except TwinError as error:
            self._outcome = {"key": key, "status": "refused", "message": str(error)}


def _texts(text: str) -> dict[str, str]:
    try:
        data = json.loads(text or "{}")
    except (ValueError, RecursionError):
        data = None
    if not isinstance(data, dict) or not all(isinstance(value, str) for value in data.values()):
        raise InputError(f"{text!r} is not a JSON object of texts")
    return data
