"""The controls in Meshcat's own panel: time, and a slider for each joint that a controller forwards commands to."""

from math import floor, log10

import numpy as np
from pydrake.geometry import Meshcat

from drake_twin.systems.controller import Interface
from drake_twin.twin import Twin

PLAY_PAUSE, STEP, RESET, SPEED, SIM_TIME = "Play / Pause", "Step", "Reset", "Speed (x real)", "Sim time (s)"

_FASTEST, _SLOWEST = 4.0, 0.05
_LONGEST_TIME = 1e5  # s
_WIDEST_SLIDER = 20.0  # rad/s or m/s: joints may have no velocity limit, or a very large one


class Panel:
    """Puts controls on a Meshcat page and obeys them.

    Drake's Meshcat collects clicks and slider values in a thread of its own; `obey` reads them, in the thread that
    owns the twin, between two steps.

    Args:
        meshcat: the page.
        twin: what the controls steer.
    """

    def __init__(self, meshcat: Meshcat, twin: Twin):
        self._meshcat = meshcat
        self._twin = twin
        meshcat.AddButton(PLAY_PAUSE, "Space")
        meshcat.AddButton(STEP, "KeyN")
        meshcat.AddButton(RESET, "KeyR")
        speed = min(max(twin.real_time_rate, _SLOWEST), _FASTEST)
        meshcat.AddSlider(SPEED, _SLOWEST, _FASTEST, 0.05, speed)
        # The panel has no text line: a slider that nobody needs to move shows the time.
        meshcat.AddSlider(SIM_TIME, 0.0, _LONGEST_TIME, 0.01, twin.time)
        self._clicks = dict.fromkeys((PLAY_PAUSE, STEP, RESET), 0)
        self._speed = meshcat.GetSliderValue(SPEED)
        self._sliders: dict[str, list[str]] = {}
        for topic, commanded in twin.commanded.items():
            limits = twin.command_limits(topic)
            if limits:
                self._sliders[topic] = [
                    self._add_joint_slider(commanded.robot, interface, *bounds) for interface, bounds in limits.items()
                ]
        self._values_seen = {topic: self._values(topic) for topic in self._sliders}
        self._at_rest = {topic: tuple(values.tolist()) for topic, values in self._values_seen.items()}
        self._command_shown: dict[str, tuple[float, ...]] = {}

    def obey(self) -> None:
        """Does what was clicked and moved since the last call, and shows commands that came from elsewhere."""
        if self._clicked(PLAY_PAUSE) % 2 == 1:
            self._twin.paused = not self._twin.paused
        steps = self._clicked(STEP)
        if steps:
            self._twin.pause()
            self._twin.step(steps)
        if self._clicked(RESET):
            self._twin.reset()
        speed = self._meshcat.GetSliderValue(SPEED)
        if speed != self._speed:
            self._speed = speed
            self._twin.real_time_rate = speed
        for topic in self._sliders:
            self._obey_sliders(topic)
        if self._meshcat.GetSliderValue(SIM_TIME) != round(self._twin.time, 2):
            self._meshcat.SetSliderValue(SIM_TIME, round(self._twin.time, 2))

    def _add_joint_slider(self, robot: str, interface: Interface, lower: float, upper: float) -> str:
        """A slider whose name still tells joints apart where the panel cuts it off, after some sixteen letters."""
        joint = interface.joint
        positions = self._twin.start_positions(robot) if interface.name == "position" else {}
        rest = positions.get(joint, 0.0)
        short = joint.removeprefix(f"{robot}_").removesuffix("_joint")
        name = f"{robot}/{short}"
        if name in self._meshcat.GetSliderNames():
            name = f"{robot}/{joint}"
        lower, upper = max(lower, -_WIDEST_SLIDER), min(upper, _WIDEST_SLIDER)
        step = 10.0 ** floor(log10(max(upper - lower, 1e-3) / 100.0))
        self._meshcat.AddSlider(name, lower, max(upper, lower + step), step, min(max(rest, lower), upper))
        return name

    def _clicked(self, button: str) -> int:
        """How often a button was clicked since the last call."""
        clicks = int(self._meshcat.GetButtonClicks(button))
        new, self._clicks[button] = clicks - self._clicks[button], clicks
        return new

    def _values(self, topic: str) -> np.ndarray:
        return np.array([self._meshcat.GetSliderValue(name) for name in self._sliders[topic]])

    def _obey_sliders(self, topic: str) -> None:
        values = self._values(topic)
        if not np.array_equal(values, self._values_seen[topic]):  # a person moved one: from now on it is theirs
            self._twin.silence(topic)
            self._twin.publish(topic, values)
            self._values_seen[topic] = values
            self._command_shown[topic] = tuple(values.tolist())
            return
        command = self._twin.command(topic)
        shown = self._at_rest[topic] if command is None else tuple(np.asarray(command.data).tolist())
        if shown != self._command_shown.get(topic):
            for name, value in zip(self._sliders[topic], shown, strict=True):
                self._meshcat.SetSliderValue(name, value)
            self._command_shown[topic] = shown
            self._values_seen[topic] = self._values(topic)
