from pathlib import Path

import pytest
import yaml
from launch_files import launch_python, write

from drake_twin.errors import InputError
from drake_twin.ros2.launched import ParameterText

SOURCE = """\
amcl:
  ros__parameters:
    use_sim_time: true
    base_frame: base
    base_frame: base_link
controller_server:
  ros__parameters:
    use_sim_time: true
    plugins: [a, b]
"""
BEFORE = "from nav2_common.launch import *\nhere = os.path.dirname(__file__) + '/nav2.yaml'"


def rewritten(folder, substitution, source=SOURCE, **arguments):
    write(folder / "nav2.yaml", source)
    entities = f"Node(package='p', executable='e', parameters=[{substitution}])"
    return launch_python(folder, entities, BEFORE, **arguments).processes[0].parameters[0]


def test_values_and_keys_are_replaced(tmp_path):
    result = rewritten(
        tmp_path,
        """RewrittenYaml(source_file=here, root_key=LaunchConfiguration("ns"), convert_types=True,
                param_rewrites={"use_sim_time": LaunchConfiguration("sim"), "amcl.ros__parameters.base_frame": "b"},
                key_rewrites={"plugins": "modules"}, value_rewrites={"a": "c"})""",
        ns="r1",
        sim="false",
    )
    assert isinstance(result, ParameterText)
    assert result.file == tmp_path / "nav2.yaml"
    assert yaml.safe_load(result.text) == {
        "r1": {
            "amcl": {"ros__parameters": {"use_sim_time": False, "base_frame": "b"}},
            "controller_server": {"ros__parameters": {"use_sim_time": False, "modules": ["c", "b"]}},
        }
    }


def test_without_a_namespace_nothing_is_put_around_it(tmp_path):
    result = rewritten(tmp_path, "RewrittenYaml(here, param_rewrites={}, root_key='')")
    assert list(yaml.safe_load(result.text)) == ["amcl", "controller_server"]


def test_rewriting_goes_together_with_substitutions_in_the_file(tmp_path):
    result = rewritten(
        tmp_path,
        "ParameterFile(RewrittenYaml(here, param_rewrites={'x': '2'}, convert_types=True), allow_substs=True)",
        source="n:\n  ros__parameters:\n    x: 1\n    name: $(var who)\n",
        who="me",
    )
    assert yaml.safe_load(result.text) == {"n": {"ros__parameters": {"x": 2, "name": "me"}}}


def test_texts_are_replaced_if_the_condition_holds(tmp_path):
    given = "ReplaceString(here, {{'base_link': LaunchConfiguration('ns')}}, condition=IfCondition('{}'))"
    assert "base_frame: r1\ncontroller" in rewritten(tmp_path, given.format("true"), ns="r1").text
    assert rewritten(tmp_path, given.format("false"), ns="r1") == tmp_path / "nav2.yaml"


def test_the_rewritten_file_can_be_handed_to_an_executable(tmp_path):
    write(tmp_path / "nav2.yaml", SOURCE)
    launched = launch_python(tmp_path, "LogInfo(msg=ReplaceString(here, {'amcl': 'AMCL'}))", BEFORE)
    assert Path(launched.log[0]).read_text().startswith("AMCL:")


def test_whether_a_file_has_a_node(tmp_path):
    write(tmp_path / "nav2.yaml", SOURCE)
    entities = "LogInfo(msg=HasNodeParams(here, 'amcl')), LogInfo(msg=HasNodeParams(here, 'none'))"
    assert launch_python(tmp_path, entities, BEFORE).log == ("True", "False")


def test_poses_of_robots_from_the_command_line(tmp_path):
    launched = launch_python(
        tmp_path,
        "LogInfo(msg=str(ParseMultiRobotPose('robots').value()['b']))",
        BEFORE,
        robots="a={x: 1.0}; b={x: 2, yaw: 0.5}",
    )
    assert launched.log == ("{'x': 2.0, 'y': 0.0, 'z': 0.0, 'roll': 0.0, 'pitch': 0.0, 'yaw': 0.5}",)


def test_a_file_that_is_absent_or_wrong_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nav2.yaml:2: this is not valid YAML"):
        rewritten(tmp_path, "RewrittenYaml(here, {})", source="a: [\n}")
    with pytest.raises(InputError, match="package 'gone' is absent, and a file of it is read"):
        rewritten(tmp_path, "RewrittenYaml([FindPackageShare('gone'), '/x.yaml'], {})")


def test_aliases_that_stand_for_gigabytes_are_refused(tmp_path):
    bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n"
    bomb += "".join(f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(9 * [f'*{chr(97 + i)}'])}]\n" for i in range(9))
    with pytest.raises(InputError, match="holds more than 200000 values"):
        rewritten(tmp_path, "RewrittenYaml(here, {})", source=bomb)
