"""A film of a run, on a grid of simulation times; a process of its own draws and writes it."""

import subprocess
from contextlib import ExitStack
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from pydrake.geometry import FrameId, Role

from drake_twin.description.surroundings import Surroundings
from drake_twin.errors import RunError
from drake_twin.film.film_process import DONE, NO_OPENGL, READY
from drake_twin.film.kinds import PICTURE, Format
from drake_twin.film.stage import Subjects
from drake_twin.python_process import python_command, stops_held_back
from drake_twin.sensors.cameras.scene import SeenScene, seen_scene
from drake_twin.shared_viewer.shared_scene import scene_graph_of
from drake_twin.twin.twin import Twin
from drake_twin.whole_file import whole_stream

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
_MESA = "it needs Mesa: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri"


class Film:
    """A film of a twin, which changes nothing in it: picture k shows simulation time k / rate.

    The simulation waits where it is more than about a second ahead of what is drawn, so that no picture is left out.
    The file appears when the film is finished; until then it is as before.

    Args:
        file: The file; its suffix, one of `drake_twin.film.kinds.SUFFIXES`, tells its format.
        form: Its pictures.

    Raises:
        RunError: If the file cannot be written.
    """

    def __init__(self, file: Path, form: Format):
        self._file, self._form = file, form
        self._problem = ""
        self._count = 0  # pictures
        self._can_draw = self._is_over = False
        self._scene: tuple[object, SeenScene] | None = None  # the diagram and what is seen of it
        self._twin: Twin | None = None
        self._output = ExitStack()
        try:
            stream = self._output.enter_context(whole_stream(file))
        except OSError as error:
            raise RunError(f"the film {file} cannot be written ({error.strerror})") from None
        ours, theirs = Pipe()
        numbers = (theirs.fileno(), stream.fileno())
        with stops_held_back():
            self._process = subprocess.Popen(
                [*python_command("drake_twin.film.film_process"), *map(str, numbers)],
                pass_fds=numbers,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
        theirs.close()
        self._link: Connection = ours
        self._send(file.suffix.lower(), form)

    def shoot(self, twin: Twin) -> None:
        """Film a twin from now on, in place of the one before.

        Raises:
            RunError: If pictures cannot be drawn on this machine.
        """
        if twin is self._twin:
            return
        self._twin = twin
        self._show_scene(twin)
        # Every twin has the clock.
        twin.subscribe("/clock", lambda _: self._take(twin), rate=self._form.rate)
        if self._problem:
            self._give_up()

    def finish(self) -> None:
        """End the film and write it.

        Raises:
            RunError: If it could not be drawn or written, unless `shoot` has raised it; the file is as before then.
        """
        if self._is_over:
            return
        if self._twin is not None and (self._count == 0 or self._file.suffix.lower() == PICTURE):
            self._take(self._twin)  # of the last moment; a film's last picture stands until then
        self._send("end")
        while not self._problem and self._answer() != DONE:
            pass
        if self._problem:
            self._give_up()
        self._end_process()
        try:
            self._output.close()
        except OSError as error:
            raise RunError(self._text(error.strerror or str(error))) from None

    def _take(self, twin: Twin) -> None:
        if self._problem or twin is not self._twin:
            return
        if self._scene is None or self._scene[0] is not twin.diagram:
            self._show_scene(twin)
        assert self._scene is not None
        self._count += 1
        self._send("picture", _poses(twin, self._scene[1]))

    def _show_scene(self, twin: Twin) -> None:
        seen = seen_scene(twin.plant, scene_graph_of(twin).model_inspector(), Surroundings())
        self._scene = twin.diagram, seen
        self._send("scene", seen, subjects_of(twin, seen))
        self._answer()

    def _send(self, *message: object) -> None:
        if self._problem:
            return
        try:
            self._link.send(message)
        except (BrokenPipeError, ConnectionResetError):
            self._answer()

    def _answer(self) -> str:
        """Return what the process says next; what has gone wrong is kept as the problem."""
        if self._problem:
            return ""
        try:
            kind, text = self._link.recv()
        except (EOFError, ConnectionResetError):
            kind = "" if self._can_draw else NO_OPENGL
            text = f"the process that draws it ended with exit code {self._process.wait()}"
        self._can_draw |= kind == READY
        if kind not in (READY, DONE):
            self._problem = f"{text.rstrip('.')}; {_MESA}" if kind == NO_OPENGL else text
        return str(kind)

    def _give_up(self) -> None:
        self._is_over = True
        self._end_process()
        error = RunError(self._text(self._problem))
        self._output.__exit__(RunError, error, None)
        raise error

    def _end_process(self) -> None:
        self._link.close()
        self._process.kill()  # it has nothing to finish
        self._process.wait()

    def _text(self, reason: str) -> str:
        return f"the film {self._file} cannot be written ({reason}); a file that was there before is unchanged"


def subjects_of(twin: Twin, seen: SeenScene) -> Subjects:
    """Return what the camera keeps in the picture: the shapes of the robots.

    Args:
        twin: The twin.
        seen: What is seen of it.
    """
    plant, inspector = twin.plant, scene_graph_of(twin).model_inspector()
    fixed = plant.CreateDefaultContext()
    corners, moves = [], []
    for robot in twin.robots:
        for index in plant.GetBodyIndices(twin.built.robots[robot].instance):
            body = plant.get_body(index)
            place = seen.bodies.index(int(index)) if int(index) in seen.bodies else -1
            frame: FrameId = plant.GetBodyFrameIdOrThrow(index)
            for geometry in inspector.GetGeometries(frame, Role.kIllustration):
                box = inspector.GetObbInGeometryFrame(geometry)
                if box is None:
                    continue
                X_BO = inspector.GetPoseInFrame(geometry) @ box.pose()
                X = X_BO if place >= 0 else plant.EvalBodyPoseInWorld(fixed, body) @ X_BO
                corners.append((X @ (_CORNERS * box.half_width()).T).T)
                moves.append(place)
    return Subjects(np.array(corners).reshape(-1, 8, 3), np.array(moves, dtype=int))


def _poses(twin: Twin, seen: SeenScene) -> np.ndarray:
    port = twin.plant.get_body_poses_output_port()
    return seen.poses(port.Eval(twin.plant.GetMyContextFromRoot(twin.context)))
