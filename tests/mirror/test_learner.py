"""What the twin could learn from the robot is offered as a file, and taken over by nobody but the user."""

from dataclasses import replace

import pytest
from recorded import write_bag

from drake_twin import Twin
from drake_twin.builder.demo import demo_scenario
from drake_twin.mirror.__main__ import main
from drake_twin.mirror.heard import Heard
from drake_twin.mirror.learner import Learner
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

COMMANDS, STATES = "/robot_1/forward_velocity_controller/commands", "/robot_1/joint_states"
PAYLOAD = "robot_1.claw.payload"
TRUE = 0.15  # kg


@pytest.fixture(scope="module")
def heard():
    """What an arm with a payload says that its twin does not know of."""
    scenario = replace(demo_scenario("arduinobot", 1, drive=False), values={PAYLOAD: TRUE})
    found = []
    with Twin(scenario) as twin:
        for topic in (COMMANDS, STATES):
            assert topic in {item.name for item in twin.graph.endpoints}
        for step in range(150):
            twin.advance_to(0.02 * step)
            if step >= 5 and step % 12 == 5:
                speed = (0.8, -0.8, 0.6, -0.6)[step // 12 % 4]
                message = {"data": [speed, speed, -speed, 0.0]}
                twin.publish(COMMANDS, message)
                found.append((twin.time, COMMANDS, message))
            found.append((twin.time, STATES, twin.joint_states("robot_1")))
    from drake_twin.messages.interface_types import make

    return [
        Heard(time, topic, "std_msgs/msg/Float64MultiArray", make("std_msgs/msg/Float64MultiArray", message))
        if topic == COMMANDS
        else Heard(time, topic, "sensor_msgs/msg/JointState", message)
        for time, topic, message in found
    ]


def test_a_payload_is_offered_with_its_error_and_the_target_stays(heard, tmp_path, capsys):
    file = tmp_path / "arm.yaml"
    file.write_text(scenario_to_yaml(demo_scenario("arduinobot", 1, drive=False)))
    before = file.read_bytes()
    write_bag(tmp_path / "bag", heard)
    words = ["--bag", str(tmp_path / "bag"), "--fit", f"{PAYLOAD}=0.01:1", "--patch", str(tmp_path / "patch.yaml")]
    assert main([str(file), *words]) in (0, 3)
    said = capsys.readouterr().out
    assert f"offered: {tmp_path / 'patch.yaml'}: {PAYLOAD}: 0.1" in said
    assert "±" in said
    scenario = ScenarioFile.read(tmp_path / "patch.yaml").scenario
    assert scenario.values[PAYLOAD] == pytest.approx(TRUE, abs=0.005)
    assert file.read_bytes() == before


def test_what_is_not_to_be_trusted_is_not_offered(heard, tmp_path):
    learner = Learner(demo_scenario("arduinobot", 1, drive=False), ["robot_1.base_link.mass=5:30"], tmp_path / "p.yaml")
    for item in heard[:40]:
        learner.hear(item)
    assert not learner.is_due
    learner.begin({COMMANDS, STATES})
    said = learner.outcome(wait=True)
    assert said is not None
    assert said.startswith("nothing is offered: ")
    assert not (tmp_path / "p.yaml").exists()
    assert learner.outcome() is None
    learner.begin({COMMANDS, STATES})
    learner.close()


def test_only_the_last_seconds_are_kept(heard, tmp_path):
    learner = Learner(demo_scenario("arduinobot", 1, drive=False), [], tmp_path / "p.yaml", window=1.0)
    for item in heard:
        learner.hear(item)
    assert learner.is_due
    assert 50 < len(learner._kept) < 60


@pytest.mark.parametrize("words", [("--fit", "a=1:2"), ("--patch", "p.yaml")])
def test_what_is_found_and_where_it_is_offered_belong_together(capsys, words):
    assert main(["--robots", "1", "--bag", "x", *words]) == 2
    assert "--fit says what is to be found, and --patch where it is offered: give both" in capsys.readouterr().err
