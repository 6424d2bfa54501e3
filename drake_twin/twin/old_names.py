"""Names that `Twin` had before its methods were grouped: they work, and warn with the name of today."""

import warnings
from operator import attrgetter
from typing import Any


class Moved:
    """An older name of an attribute.

    Args:
        path: Its name of today, such as ``entities.place``.
    """

    def __init__(self, path: str):
        self._path = path

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, twin: Any, owner: type | None = None) -> Any:
        if twin is None:
            return self
        self._warn()
        return attrgetter(self._path)(twin)

    def __set__(self, twin: Any, value: Any) -> None:
        self._warn()
        group, _, name = self._path.rpartition(".")
        setattr(attrgetter(group)(twin), name, value)

    def _warn(self) -> None:
        text = f"Twin.{self._name} is an older name of Twin.{self._path}"
        warnings.warn(text, DeprecationWarning, stacklevel=3)


class OldNames:
    """The older names of what `Twin` has in groups."""

    actions = Moved("graph.actions")
    apply_wrench = Moved("entities.apply_wrench")
    cancel = Moved("control.cancel")
    clear_emergency_stop = Moved("control.clear_emergency_stop")
    collision_shapes = Moved("built.shapes")
    command = Moved("graph.command")
    command_limits = Moved("graph.command_limits")
    commanded = Moved("built.commanded")
    controller_manager = Moved("control.manager")
    copy_model = Moved("entities.copy_model")
    delete = Moved("entities.delete")
    drag = Moved("entities.drag")
    emergency_stop = Moved("control.emergency_stop")
    endpoints = Moved("graph.endpoints")
    entity_state = Moved("entities.state")
    evaluate = Moved("graph.evaluate")
    first_robots = Moved("entities.first_robots")
    is_stopped = Moved("control.is_stopped")
    not_started = Moved("findings.not_started")
    paused = Moved("clock.paused")
    place = Moved("entities.place")
    plans = Moved("built.plans")
    real_time_rate = Moved("clock.real_time_rate")
    record = Moved("recorder.begin")
    recording = Moved("recorder.recording")
    release = Moved("entities.release")
    send_goal = Moved("graph.send_goal")
    sensors = Moved("entities.sensors")
    set_entity_state = Moved("entities.set_state")
    set_joint_positions = Moved("entities.set_joint_positions")
    set_time_step = Moved("clock.set_time_step")
    set_values = Moved("entities.set_values")
    silence = Moved("graph.silence")
    spawn = Moved("entities.spawn")
    start_positions = Moved("entities.start_positions")
    state_layout = Moved("entities.state_layout")
    state_vector = Moved("entities.state_vector")
    step_count = Moved("clock.step_count")
    subscribe_drafts = Moved("graph.subscribe_drafts")
    time_step = Moved("clock.time_step")
    topics = Moved("graph.topics")
    warnings = Moved("findings.warnings")
    world_file = Moved("built.world_file")
