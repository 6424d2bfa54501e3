"""The twin's side of the page: processes the requests of browsers in the twin's thread, and publishes the state."""

import json
import time as wall_clock
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any
from weakref import WeakMethod

from drake_twin.cockpit import protocol
from drake_twin.cockpit.follow_camera import FollowCamera
from drake_twin.cockpit.html_recording import HtmlRecording
from drake_twin.cockpit.joint_commands import JointCommands
from drake_twin.cockpit.looks import Looks
from drake_twin.cockpit.message_log import MessageLog
from drake_twin.cockpit.others_parts import NO_STATE, close_panels, drawing, make_overlay, make_panel, watch_panels
from drake_twin.cockpit.overlay import OVERLAY_KINDS, Overlay
from drake_twin.cockpit.panel import PANEL_KINDS, Panel
from drake_twin.cockpit.past_drawings import PastDrawings
from drake_twin.cockpit.player import Player
from drake_twin.cockpit.posed_joints import PosedJoints
from drake_twin.cockpit.real_time_factor import RealTimeFactor
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.cockpit.sensor_view import SensorView
from drake_twin.cockpit.server import PageServer
from drake_twin.cockpit.snapshot import layout_key, state, structure
from drake_twin.cockpit.stepping import Stepping
from drake_twin.cockpit.teleop import Teleop
from drake_twin.cockpit.timeline import Timeline
from drake_twin.errors import InputError
from drake_twin.findings import Kind, grouped
from drake_twin.planning.controller_plan import chained_to
from drake_twin.twin.controller_manager import STRICT
from drake_twin.twin.twin import Twin

_FRAMES_A_SNAPSHOT = 2  # the run loop makes some 30 frames a second
_RECORDING = "run.html"
_NOT_IN_CALLBACKS = (protocol.Step, protocol.RunTo, protocol.Reset, protocol.GoOnFrom, protocol.Delete)
_BETWEEN_ADVANCES = (*_NOT_IN_CALLBACKS, protocol.AskPanel)  # a panel may ask for what a callback cannot do


class Cockpit:
    """Connects the page with a twin. `process_requests` must be called between steps, in the twin's thread.

    While a browser is connected, its requests also come through the twin's inbox, so that a command waits for no frame.

    Args:
        server: The page's server.
        scene: The page's scene.
        twin: The twin.
        only_displayed: Whether the twin stays paused and the page sets its joint positions.
        player: What moves a twin that does not advance, in its place.

    Attributes:
        sensors: The sensors that the page shows.
        panels: The Python halves of its panels by name.
    """

    def __init__(
        self,
        server: PageServer,
        scene: Scene,
        twin: Twin,
        *,
        only_displayed: bool = False,
        player: Player | None = None,
    ):
        self._server = server
        self._scene = scene
        self._twin = twin
        self._only_displayed = only_displayed
        self._player = player
        self._clock: Player | Twin = player or twin
        self._log = MessageLog()
        for kind, sentence in grouped(twin.findings if player is None else player.findings):
            if kind is not Kind.WINDOW:
                self._log.add("warning" if kind is Kind.MENDED else str(kind), sentence)
        for level, text, self._log.time in () if player is None else player.logs:
            self._log.add(level, text)
        self._end_log = self._log.follow(twin)
        self._clients: frozenset[int] = frozenset()
        self._asked: deque[tuple[int, protocol.Request]] = deque()
        heard = WeakMethod(self._hear)  # the server's thread must not keep the twin
        server.listen(lambda: (hear := heard()) and hear())
        self._frame = 0
        self._factor = RealTimeFactor()
        self._overlays: dict[str, Overlay] = {}
        self.panels: dict[str, Panel] = {}
        for name, panel in PANEL_KINDS.items():
            own = None if player is None else player.panels.get(name)
            self.panels[name] = own or make_panel(panel, twin)
            server.offer(f"panel_{name}.js", panel.script)
        self._drawing = drawing(self.panels)
        self._camera = FollowCamera(scene)
        make_sensors = partial(SensorView, twin) if player is None else player.sensors
        self._past = PastDrawings(lambda: twin.time, scene, server.send_bytes)
        self.sensors = make_sensors(scene, self._past.send_picture)
        self._timeline = Timeline(twin, scene, self._past)
        self._recording: HtmlRecording | None = None
        self._recordings = 0
        self._looks = Looks()
        self._layout = layout_key(twin)  # as the robots are at first: the page stays as it is when some come or go
        self._stepping = Stepping(twin)
        self._published_log = -1
        self._published_timeline: dict[str, Any] | None = None
        self._read_robots()

    def close(self) -> None:
        """Disconnect from the twin; the server continues, and keeps what it is asked for the next one."""
        self._server.listen(lambda: None)
        if self._clients:
            self._twin.inbox.close(urgent=False)
        self._end_log()
        self._stepping.close()
        for overlay in self._overlays.values():
            overlay.remove()
        self.sensors.close()
        self._timeline.close()
        self._past.close()
        watch_panels(self.panels, False)
        close_panels(self.panels)
        self._camera.follow("", self._twin)

    def process_requests(self, *, in_callback: bool = False) -> None:
        """Process the requests since the last call, draw the scene and publish the state.

        Args:
            in_callback: Whether a callback of the twin is the caller; what a callback cannot do is refused then.
        """
        self._process(in_callback=in_callback)
        if not in_callback:
            self._try(self._stepping.proceed)
        self._try(self._teleop.publish)
        with self._server.together():
            if self._server.is_watched:
                self.draw()
            self._frame += 1
            self._publish()

    def _hear(self) -> None:
        """Note in the server's thread that there are requests."""
        self._twin.inbox.put(self._process_at_once)

    def _process_at_once(self) -> None:
        """Process the requests that a callback may, up to the first one that waits for the next frame."""
        self._process(in_callback=True, only_now=self._twin.frames.are_running)

    def _process(self, *, in_callback: bool, only_now: bool = False) -> None:
        self._log.time = self._clock.time
        self._follow_robots()
        self._asked += self._server.requests()
        while self._asked and not (only_now and isinstance(self._asked[0][1], _BETWEEN_ADVANCES)):
            self._try(self._do, *self._asked.popleft(), in_callback)
            self._follow_robots()

    def draw(self) -> None:
        """Draw the twin's present state, with the overlays that are shown, or the moment that is looked at."""
        looked = self._timeline.draw(wall_clock.perf_counter())
        time = self._clock.time if looked is None else looked
        for draw in self._drawing:
            self._try(draw, self._scene, time)
        if looked is not None:
            return
        frame = self._scene.frame(self._twin)
        self._scene.show(frame)
        self._timeline.note(frame)
        for overlay in self._overlays.values():
            overlay.draw()
        self._camera.draw(self._twin)

    def _follow_robots(self) -> None:
        if self._plans is not self._twin.built.plans:
            self._read_robots()

    def _read_robots(self) -> None:
        """Read the twin's present robots: their sliders, drives, joints and overlays."""
        self._plans = self._twin.built.plans
        self._commands = JointCommands(self._twin)
        self._teleop = Teleop(self._twin)
        self._posed = PosedJoints(self._twin)
        self.sensors.read_robots()
        for name in tuple(self._overlays):
            self._show(name, False)
            self._show(name, True)
        self._structure: str | None = None

    def _try(self, action: Callable[..., None], *arguments: Any) -> None:
        """Call a function; if the twin refuses, add the error to the page's messages."""
        try:
            action(*arguments)
        except InputError as error:
            self._log.add("error", str(error))

    def _do(self, client: int, request: protocol.Request, in_callback: bool) -> None:
        if in_callback and isinstance(request, _NOT_IN_CALLBACKS):
            name = type(request).__name__
            raise InputError(f"{name} is refused while the program advances the twin itself; twin.run() accepts it")
        match request:
            case protocol.Gone():
                self._teleop.leave(client)
            case protocol.Show(what, on):
                self._show(what, on)
            case protocol.ShowSensor(sensor, on):
                self.sensors.show(sensor, on)
                if not on:
                    self._past.forget(f"{OVERLAYS}/measured/{sensor}")
            case protocol.ColorSensor(sensor, by):
                self.sensors.color(sensor, by)
            case protocol.LookAtEfforts():
                self._looks.at_efforts()
            case protocol.LookAtRobots(robots):
                self._looks.at_robots(robots, self._twin.robots)
            case protocol.Follow(robot):
                self._camera.follow(robot, self._twin)
            case protocol.AskPanel(panel, data):
                self._ask_panel(panel, data)
            case protocol.PoseJoint(robot, joint, position) if self._only_displayed:
                self._posed.move(robot, joint, position)
            case _ if self._player is not None:
                self._player.do(request)
            case _ if not self._only_displayed:
                self._steer(client, request)

    def _steer(self, client: int, request: protocol.Request) -> None:
        """Process a request that needs physics."""
        twin = self._twin
        self._stepping.end_before(request)
        match request:
            case protocol.Play():
                twin.play()
            case protocol.Pause():
                twin.pause()
            case protocol.Step(count):
                self._stepping.begin(count)
            case protocol.RunTo(time):
                self._stepping.run_to(time)
            case protocol.Reset():
                twin.reset()
                self._commands.forget()
                self._teleop.forget()
            case protocol.Look() | protocol.LookBy() | protocol.Replay() | protocol.Loop() | protocol.LookAtNow():
                self._timeline.do(request)
            case protocol.GoOnFrom(time):
                self._go_on_from(time)
            case protocol.SetRate(rate):
                twin.clock.real_time_rate = rate
            case protocol.SetTimeStep(seconds):
                twin.clock.set_time_step(seconds)
            case protocol.Switch(robot, controller, active):
                self._switch(robot, controller, active)
            case protocol.SwitchTo(robot, controller):
                self._switch_to(robot, controller)
            case protocol.MoveJoint(topic, index, value):
                self._commands.move(topic, index, value)
            case protocol.Drive(topic, x, y, turn, up):
                self._teleop.drive(client, topic, (x, y, turn, up))
            case protocol.EmergencyStop(robot):
                twin.control.emergency_stop(robot)
                self._commands.forget()
            case protocol.ClearEmergencyStop(robot):
                twin.control.clear_emergency_stop(robot)
            case protocol.Record(on):
                self._record(on)
            case protocol.Delete(robot):
                twin.entities.delete(robot)

    def _go_on_from(self, time: float) -> None:
        now, reached = self._twin.time, self._timeline.go_on_from(time)
        self._commands.forget()
        self._teleop.forget()
        self._log.time = reached
        self._log.add("info", f"the twin went back from {now:.3f} s and continues from {reached:.3f} s")

    def _switch(self, robot: str, controller: str, active: bool) -> None:
        manager = self._twin.control.manager(robot)
        if active and manager.states.get(controller) is None:
            manager.load_controller(controller)
        if active and manager.states.get(controller) == "unconfigured":
            manager.configure_controller(controller)
        names = [controller]
        answer = manager.switch_controller(names if active else (), () if active else names, STRICT)
        if not answer:
            raise InputError(f"{robot}: {answer.message}")
        self._commands.forget()

    def _switch_to(self, robot: str, controller: str) -> None:
        """Activate a controller in place of those that command its joints by whatever interface, and say which.

        Those that it writes to, in a chain, are activated with it; those that write to what is replaced end with that.
        """
        manager = self._twin.control.manager(robot)
        plan = next(plan for plan in self._twin.built.plans if plan.name == robot)
        joints = {item.name: {claim.joint for claim in item.claims} for item in plan.controllers}
        below = {item.name: chained_to(item, joints) for item in plan.controllers}
        chain = [controller]
        for name in chain:  # it grows: down the chain
            chain += [other for other in below.get(name, ()) if other not in chain]
        own = {joint for name in chain for joint in joints.get(name, ())}
        replaced = [name for name in manager.active if name not in chain and joints[name] & own]
        for name in replaced:  # it grows: up the chain
            replaced += [other for other in manager.active if name in below[other] and other not in replaced]
        started = [name for name in chain if name == controller or not manager.is_active(name)]
        answer = manager.switch_controller(started, replaced, STRICT)
        if not answer:
            raise InputError(f"{robot}: {answer.message}")
        self._commands.forget()
        states = [*(f"{name} active" for name in started), *(f"{name} inactive" for name in replaced)]
        self._log.add("info", f"{robot}: switched: {', '.join(states)}")

    def _show(self, name: str, on: bool) -> None:
        known = OVERLAY_KINDS
        if name not in known:
            raise known.unknown(name)
        if on and name not in self._overlays:
            self._overlays[name] = make_overlay(known[name], self._scene, self._twin)
            self._timeline.tell(self._overlays[name])
        elif not on and name in self._overlays:
            self._overlays.pop(name).remove()
            self._past.forget(f"{OVERLAYS}/{name}")

    def _ask_panel(self, name: str, data: str) -> None:
        if name not in self.panels:
            raise InputError(f"unknown panel {name!r}", value=name, valid=self.panels)
        try:
            value = json.loads(data)
        except (ValueError, RecursionError):
            raise InputError(f"panel {name!r} sent data that is not JSON: {data!r}") from None
        self.panels[name].ask(value)

    def _record(self, on: bool) -> None:
        if on and self._recording is None:
            self._recording = HtmlRecording(self._scene, self._twin)
        elif not on and self._recording is not None:
            self._server.offer(_RECORDING, self._recording.finish().encode())
            self._recording = None
            self._recordings += 1

    def _publish(self) -> None:
        """Publish a snapshot if a browser is connected; one that has just connected gets everything."""
        clients = frozenset(self._server.clients)
        if clients == self._clients and (not clients or self._frame % _FRAMES_A_SNAPSHOT):
            return
        if bool(clients) != bool(self._clients):
            (self._twin.inbox.open if clients else self._twin.inbox.close)(urgent=False)
            self.sensors.watch(bool(clients))
            watch_panels(self.panels, bool(clients))
            if self._player is None and not self._only_displayed:
                self._timeline.watch(bool(clients))
        newcomers, self._clients = clients - self._clients, clients
        paused = self._twin.clock.paused if self._player is None else self._player.paused
        factor = self._factor.note(wall_clock.perf_counter(), self._clock.time, paused=paused or not clients)
        if clients and (newcomers or self._frame % _FRAMES_A_SNAPSHOT == 0):
            self.publish(factor, everything=bool(newcomers))

    def publish(self, factor: float | None = None, *, everything: bool = True) -> None:
        """Publish the present state.

        Args:
            factor: The real-time factor, if it is known.
            everything: Whether to publish what has not changed, too.
        """
        texts: dict[str, str] = {}
        if self._structure is None or everything:
            whole = structure(self._twin, self._commands, self._teleop, only_displayed=self._only_displayed)
            whole["layout"] = self._layout
            listing = {
                "playback": self._player is not None,
                "sensors": self.sensors.listing() if not self._only_displayed else [],
            }
            self._structure = _json(whole | listing)
            texts["robots"] = self._structure
        if everything or self._log.version != self._published_log:
            self._published_log = self._log.version
            texts["messages"] = _json(self._log.as_plain())
        timeline = self._timeline.as_plain()
        if everything or timeline != self._published_timeline:
            self._published_timeline = timeline
            texts["timeline"] = _json(timeline)
        more = {
            "real_time_factor": None if factor is None else round(factor, 3),
            "shown": sorted(self._overlays),
            "followed": self._camera.robot,
            "recording": self._recording is not None,
            "recordings": self._recordings,
            "sensors": self.sensors.state(),
            "panels": {name: data for name, item in self.panels.items() if (data := item.state()) is not NO_STATE},
        }
        present = state(self._twin, self._commands, more, self._looks.robots, with_efforts=self._looks.need_efforts)
        self._looks.pass_snapshot()
        if self._player is not None:
            self._player.amend(present)
        texts["state"] = _json(present)
        self._server.publish(texts)


def _json(value: Any) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)
