"""The names that robots and namespaces can have, through each door that takes them."""

import subprocess
import sys

import pytest

from drake_twin import InputError, Robot, Scenario, TwinBuilder
from drake_twin.scenario.names import LONGEST_NAME, name_in_twin, problem_of_name, problem_of_namespace
from drake_twin.scenario.scenario_file import ScenarioFile

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
REFUSED = ["..", ".", "a/b", "a\nb", "a b", "a::b", "", "\0", "~", "{a}", "robоt", "é", "²", "a\u202eb", "r\ud800"]
REFUSED += [10_000 * "a", (LONGEST_NAME + 1) * "a", "a\n"]
TAKEN = ["a", "9a", "a-b", "_a", "A__b", LONGEST_NAME * "a"]


@pytest.mark.parametrize("name", REFUSED)
def test_a_robot_of_no_name_is_one_paragraph(name):
    for door in (
        lambda: Scenario(robots=(Robot(name, ARM),)),
        lambda: TwinBuilder().robot(name, ARM).scenario(),
        lambda: ScenarioFile(f'robots: [{{"name": {name!r}, "model": m}}]', "it.yaml").scenario,
    ):
        with pytest.raises(InputError) as caught:
            door()
        text = str(caught.value)
        assert len(text) < 300
        assert "\n" not in text
    assert "is not a name: use letters from A to Z, digits, '_' and '-', 100 at most" in str(problem_of_name(name))


@pytest.mark.parametrize("name", TAKEN)
def test_names_of_ros_and_gazebo_are_taken(name):
    assert problem_of_name(name) is problem_of_namespace(f"/team/{name}") is None
    assert Scenario(robots=(Robot(name, ARM),)).robots[0].topic_namespace == f"/{name}"


@pytest.mark.parametrize("namespace", ["..", "a b", "a//b", "a\n", "é", "a/../b", 10_000 * "a", "/".join(["a"] * 500)])
def test_a_namespace_that_is_none_is_refused(namespace):
    with pytest.raises(InputError, match=r"robots.0.namespace: .* is not a namespace: use names with '/' between them"):
        Scenario(robots=(Robot("r", ARM, namespace=namespace),))


@pytest.mark.parametrize("namespace", ["", "/", "a", "/a", "/team/a/", "team/a-1"])
def test_namespaces_are_taken_with_and_without_slashes(namespace):
    assert Scenario(robots=(Robot("r", ARM, namespace=namespace),)).robots[0].namespace == namespace


@pytest.mark.parametrize("name", [*REFUSED, "world"])
def test_a_file_whose_robot_has_another_name_gets_one_that_can_be_taken(name):
    assert problem_of_name(name_in_twin(name)) is None


def test_a_spawn_what_a_scenario_refuses():
    with TwinBuilder().robot("arm", ARM).build() as twin:
        before = twin.state_sha256()
        for name in REFUSED:
            with pytest.raises(InputError, match="is not a name"):
                twin.entities.spawn(Robot(name, ARM))
        with pytest.raises(InputError) as caught:
            twin.robot_state(10_000 * "a")
        assert len(str(caught.value)) < 200
        assert (twin.robots, twin.state_sha256()) == (("arm",), before)


def test_the_program_ends_with_two_and_a_paragraph(tmp_path):
    file = tmp_path / "it.yaml"
    file.write_text(f"robots:\n  - name: a/b\n    model: {ARM}\n")
    command = [sys.executable, "-m", "drake_twin.run", str(file), "--headless"]
    run = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert run.returncode == 2
    assert run.stderr.startswith(f"error: {file}:2: robots.0.name: 'a/b' is not a name")
    assert "Traceback" not in run.stderr
