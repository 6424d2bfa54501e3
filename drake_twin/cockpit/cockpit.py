"""The page's other end: does what browsers ask of a twin, in the twin's thread, and tells them how it is."""

import json
import logging
import time as wall_clock
from collections.abc import Callable
from typing import Any

from drake_twin.cockpit import protocol
from drake_twin.cockpit.follow_camera import FollowCamera
from drake_twin.cockpit.html_recording import HtmlRecording
from drake_twin.cockpit.joint_commands import JointCommands
from drake_twin.cockpit.message_log import MessageLog
from drake_twin.cockpit.overlays import Overlay, overlay_types
from drake_twin.cockpit.posed_joints import PosedJoints
from drake_twin.cockpit.real_time_factor import RealTimeFactor
from drake_twin.cockpit.scene import Scene
from drake_twin.cockpit.server import PageServer
from drake_twin.cockpit.snapshot import state, structure
from drake_twin.cockpit.teleop import Teleop
from drake_twin.errors import InputError
from drake_twin.findings import Kind, grouped
from drake_twin.scenario import LONGEST_TIME, Robot
from drake_twin.twin.controller_manager import STRICT
from drake_twin.twin.twin import Twin

_FRAMES_A_SNAPSHOT = 2  # the run loop makes some 30 frames a second
_RECORDING = "run.html"


class Cockpit:
    """Connects the page with a twin. `obey` is called between steps, in the thread that owns the twin.

    Args:
        server: the page's server.
        scene: what it draws.
        twin: the twin.
        only_displayed: whether its time stands still and its joints go where the page puts them.
    """

    def __init__(self, server: PageServer, scene: Scene, twin: Twin, *, only_displayed: bool = False):
        self._server = server
        self._scene = scene
        self._twin = twin
        self._only_displayed = only_displayed
        self._log = MessageLog()
        for kind, sentence in grouped(twin.findings):
            if kind is not Kind.WINDOW:
                self._log.say("warning" if kind is Kind.MENDED else str(kind), sentence)
        logging.getLogger("drake_twin").addHandler(self._log)
        self._clients: frozenset[int] = frozenset()
        self._frame = 0
        self._factor = RealTimeFactor()
        self._overlays: dict[str, Overlay] = {}
        self._camera = FollowCamera(scene)
        self._recording: HtmlRecording | None = None
        self._recordings = 0
        self._end_run_to: Callable[[], None] | None = None
        self._log_told = -1
        self._look_at_robots()

    def close(self) -> None:
        """Lets go of the twin; the server goes on."""
        logging.getLogger("drake_twin").removeHandler(self._log)
        if self._end_run_to is not None:
            self._end_run_to()
        for overlay in self._overlays.values():
            overlay.remove()
        self._camera.follow("", self._twin)

    def obey(self) -> None:
        """Does what was asked for since the last call, draws what is to be drawn, and tells browsers how things are."""
        self._log.time = self._twin.time
        self._look_at_newcomers()
        for client, request in self._server.requests():
            self._try(self._do, client, request)
            self._look_at_newcomers()
        self._try(self._teleop.publish)
        if self._server.is_watched:
            self._scene.draw(self._twin)
            for overlay in self._overlays.values():
                overlay.draw()
            self._camera.draw(self._twin)
        self._frame += 1
        factor = self._factor.note(wall_clock.perf_counter(), self._twin.time, paused=self._twin.paused)
        self._tell(factor)

    def _look_at_newcomers(self) -> None:
        if self._plans is not self._twin.plans:
            self._look_at_robots()

    def _look_at_robots(self) -> None:
        """Begins anew with the robots that there are now."""
        self._plans = self._twin.plans
        self._commands = JointCommands(self._twin)
        self._teleop = Teleop(self._twin)
        self._posed = PosedJoints(self._twin)
        for name in tuple(self._overlays):
            self._show(name, False)
            self._show(name, True)
        self._structure: str | None = None

    def _try(self, action: Callable[..., None], *arguments: Any) -> None:
        """Does something; what the twin refuses is said on the page and changes nothing."""
        try:
            action(*arguments)
        except InputError as error:
            self._log.say("error", str(error))

    def _do(self, client: int, request: protocol.Request) -> None:
        twin = self._twin
        match request:
            case protocol.Gone():
                self._teleop.leave(client)
            case protocol.Show(what, on):
                self._show(what, on)
            case protocol.Follow(robot):
                self._camera.follow(robot, twin)
            case protocol.PoseJoint(robot, joint, position) if self._only_displayed:
                self._posed.move(robot, joint, position)
            case _ if self._only_displayed:
                pass  # there is no time and nothing to command
            case protocol.Play():
                twin.play()
            case protocol.Pause():
                twin.pause()
            case protocol.Step(count):
                twin.pause()
                twin.step(count)
            case protocol.RunTo(time):
                self._run_to(time)
            case protocol.Reset():
                twin.reset()
                self._commands.forget()
                self._teleop.forget()
            case protocol.SetRate(rate):
                twin.real_time_rate = rate
            case protocol.SetTimeStep(seconds) if hasattr(twin, "set_time_step"):
                twin.set_time_step(seconds)
            case protocol.Switch(robot, controller, active):
                self._switch(robot, controller, active)
            case protocol.MoveJoint(topic, index, value):
                self._commands.move(topic, index, value)
            case protocol.Drive(topic, x, y, turn):
                self._teleop.drive(client, topic, (x, y, turn))
            case protocol.EmergencyStop(robot):
                twin.emergency_stop(robot)
                self._commands.forget()
            case protocol.ClearEmergencyStop(robot):
                twin.clear_emergency_stop(robot)
            case protocol.Record(on):
                self._record(on)
            case protocol.Spawn(file, name, xyz, rpy) if hasattr(twin, "spawn"):
                twin.spawn(Robot(name=name, model=file, xyz=xyz, rpy=rpy))
            case protocol.Delete(robot) if hasattr(twin, "delete"):
                twin.delete(robot)

    def _run_to(self, time: float) -> None:
        """Lets time go on and pauses at the first step that is not before a time (s)."""
        twin = self._twin
        if time > LONGEST_TIME:
            raise InputError(f"{time:g} s is no simulation time: {LONGEST_TIME:g} s is the longest")
        if time <= twin.time:
            raise InputError(f"{time:g} s lies in the past: the twin is at {twin.time:g} s. Reset it to start again")
        if self._end_run_to is not None:
            self._end_run_to()

        def stop(_message: Any) -> None:
            if self._twin.time >= time - 1e-9:
                self._twin.pause()
                if self._end_run_to is not None:
                    self._end_run_to()
                self._end_run_to = None

        # The grid of simulation times with this spacing has its first point after zero there, to the step.
        self._end_run_to = twin.subscribe("/clock", stop, rate=1.0 / time)
        twin.play()

    def _switch(self, robot: str, controller: str, active: bool) -> None:
        manager = self._twin.controller_manager(robot)
        if active and manager.states.get(controller) is None:
            manager.load_controller(controller)
        if active and manager.states.get(controller) == "unconfigured":
            manager.configure_controller(controller)
        names = [controller]
        answer = manager.switch_controller(names if active else (), () if active else names, STRICT)
        if not answer:
            raise InputError(f"{robot}: {answer.message}")
        self._commands.forget()

    def _show(self, name: str, on: bool) -> None:
        known = overlay_types()
        if name not in known:
            raise InputError(f"there is no {name!r} to be shown", value=name, valid=known)
        if on and name not in self._overlays:
            self._overlays[name] = known[name](self._scene, self._twin)
        elif not on and name in self._overlays:
            self._overlays.pop(name).remove()

    def _record(self, on: bool) -> None:
        if on and self._recording is None:
            self._recording = HtmlRecording(self._scene, self._twin)
        elif not on and self._recording is not None:
            self._server.offer(_RECORDING, self._recording.finish().encode())
            self._recording = None
            self._recordings += 1

    def _tell(self, factor: float | None) -> None:
        """Publishes a snapshot where somebody sees it; a browser that has just come is told everything."""
        clients = frozenset(self._server.clients)
        newcomers, self._clients = clients - self._clients, clients
        if not clients or (self._frame % _FRAMES_A_SNAPSHOT and not newcomers):
            return
        texts: dict[str, str] = {}
        if self._structure is None or newcomers:
            self._structure = _json(
                structure(self._twin, self._commands, self._teleop, only_displayed=self._only_displayed)
            )
            texts["robots"] = self._structure
        if newcomers or self._log.version != self._log_told:
            self._log_told = self._log.version
            texts["messages"] = _json(self._log.as_plain())
        more = {
            "real_time_factor": None if factor is None else round(factor, 3),
            "shown": sorted(self._overlays),
            "followed": self._camera.robot,
            "recording": self._recording is not None,
            "recordings": self._recordings,
        }
        texts["state"] = _json(state(self._twin, self._commands, more))
        self._server.publish(texts)


def _json(value: Any) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
