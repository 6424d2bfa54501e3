"""Ctrl-C in the middle of a step, and a second thread: the twin goes on as if nothing had been."""

from threading import Event, Thread

import pytest
from conftest import ARM

from drake_twin import TwinBuilder
from drake_twin.controllers.joint_trajectory_controller import JointTrajectoryController
from drake_twin.errors import ThreadError

ENGINES = {
    "1ms": {"time_step": 0.001},
    "10ms": {"time_step": 0.01},
    "cenic": {"engine": "cenic", "time_step": 0.01},
}
CONTROLLERS = """
controller_manager:
  ros__parameters: {update_rate: 50, driver: {type: joint_trajectory_controller/JointTrajectoryController}}
driver:
  ros__parameters:
    joints: [joint_1, joint_2]
    command_interfaces: [position]
    state_interfaces: [position, velocity]
"""
GOAL = {
    "joint_names": ["joint_1", "joint_2"],
    "points": [{"positions": [0.5, 0.3], "time_from_start": {"sec": 1, "nanosec": 0}}],
}


def arm(folder, engine):
    file = folder / "controllers.yaml"
    file.write_text(CONTROLLERS)
    builder = TwinBuilder(**ENGINES[engine]).robot("arm", ARM, controllers=file, active_controllers=["driver"])
    twin = builder.build()
    twin.recorder.begin()
    twin.publish("/arm/driver/joint_trajectory", GOAL)
    return twin


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("after", [1, 2, 17])
def test_a_twin_that_is_interrupted_in_a_step_goes_on_as_if_it_had_not_been(tmp_path, monkeypatch, engine, after):
    whole = arm(tmp_path, engine)
    whole.advance_to(1.0)
    twin = arm(tmp_path, engine)
    update, calls = JointTrajectoryController.update, []

    def interrupted(self, *arguments):
        calls.append(self)
        if len(calls) == after:
            raise KeyboardInterrupt
        return update(self, *arguments)

    monkeypatch.setattr(JointTrajectoryController, "update", interrupted)
    with pytest.raises(KeyboardInterrupt):
        twin.advance_to(1.0)
    assert twin.time == pytest.approx(twin.context.get_time(), abs=1e-8)
    assert twin.time < 1.0
    twin.advance_to(1.0)
    assert twin.robot_state("arm").positions == pytest.approx(whole.robot_state("arm").positions, abs=1e-6)
    assert (twin.state_sha256() == whole.state_sha256()) or engine == "cenic"


def test_a_second_thread_is_refused_in_words_and_the_first_goes_on():
    twin = TwinBuilder(time_step=0.01).robot("arm", ARM).build()
    inside, refused = Event(), Event()

    def wait(message):
        inside.set()
        refused.wait()

    twin.subscribe("/arm/joint_states", wait)
    twin.owner.hand_over()
    thread = Thread(target=twin.advance_to, args=(0.5,), name="first")
    thread.start()
    assert inside.wait(60.0)
    try:
        with pytest.raises(ThreadError, match=r"twin.advance_to: the twin belongs to the thread 'first'"):
            twin.advance_to(1.0)
    finally:
        refused.set()
        thread.join()
    assert twin.time == pytest.approx(0.5)
