from pathlib import Path

import pytest
from launch_files import launch_python

from drake_twin.errors import InputError
from drake_twin.ros2.launched import ParameterText

URDF = "<?xml version='1.0'?><!-- note: a colon --><robot name='r'/>"


def parameters(folder, text, before="", **arguments):
    entities = f"Node(package='p', executable='e', parameters={text})"
    return launch_python(folder, entities, before, **arguments).processes[0].parameters


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("True", True),
        ("5", 5),
        ("5.0", 5.0),
        ("'5'", "5"),  # text stays text
        ("''", ""),
        ("LaunchConfiguration('five')", 5),  # a substitution is read as YAML
        ("LaunchConfiguration('yes')", True),
        ("LaunchConfiguration('empty')", ""),
        ("[LaunchConfiguration('five'), '.5']", 5.5),
        ("['/', LaunchConfiguration('five')]", "/5"),
        ("TextSubstitution(text='a b')", "a b"),
        ("LaunchConfiguration('list')", (1, 2)),
        ("[1, 2]", (1, 2)),
        ("[1, 2.5]", (1.0, 2.5)),
        ("[True, False]", (True, False)),
        ("['a', 'b']", ("a", "b")),
        ("[]", ()),
        ("[[LaunchConfiguration('five')], ['6']]", (5, 6)),
        ("ParameterValue(LaunchConfiguration('five'), value_type=str)", "5"),
        ("ParameterValue(LaunchConfiguration('five'), value_type=float)", 5.0),
        ("ParameterValue(LaunchConfiguration('five'), value_type=int)", 5),
        ("ParameterValue(LaunchConfiguration('yes'), value_type=bool)", True),
        ("ParameterValue(LaunchConfiguration('five'))", 5),
        ("ParameterValue(['a', LaunchConfiguration('five')], value_type=str)", "a5"),
        ("ParameterValue(LaunchConfiguration('list'), value_type=List[float])", (1.0, 2.0)),
        ("ParameterValue('1e-3', value_type=float)", 0.001),
        ("pathlib.Path('/a')", "/a"),
    ],
)
def test_values_are_typed_as_in_ros(tmp_path, value, expected):
    before = "import pathlib\nfrom typing import List"
    (result,) = parameters(tmp_path, f"[{{'x': {value}}}]", before, five="5", yes="true", empty="", list="[1, 2]")
    assert result == {"x": expected}
    assert type(result["x"]) is type(expected)


def test_nested_names_are_joined_with_dots_and_names_may_be_substitutions(tmp_path):
    (values,) = parameters(tmp_path, "[{'a': {'b': {'c': 1}, LaunchConfiguration('n'): 2}}]", n="d")
    assert values == {"a.b.c": 1, "a.d": 2}


def test_a_robot_description_that_yaml_misreads_stays_text_with_a_word_about_ros(tmp_path):
    for value in (f'LaunchConfiguration("d", default="""{URDF}""")', f'"""{URDF}"""'):
        launched = launch_python(
            tmp_path, f"Node(package='p', executable='e', parameters=[{{'robot_description': {value}}}])"
        )
        assert launched.processes[0].parameters == ({"robot_description": URDF},)
    launched = launch_python(
        tmp_path,
        "Node(package='p', executable='e', parameters=[{'rd': LaunchConfiguration('d', default=URDF)}])",
        f'URDF = """{URDF}"""',
    )
    (refused,) = launched.refused_by_ros
    assert refused.what.startswith("parameter 'rd' is text that ")


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("ParameterValue('abc', value_type=int)", "parameter 'x': 'abc' is not of the parameter's type, int"),
        ("ParameterValue('5.5', value_type=int)", "'5.5' is not of the parameter's type, int"),
        ("ParameterValue('5', value_type=bool)", "'5' is not of the parameter's type, bool"),
        ("object()", "which no parameter can have"),
    ],
)
def test_a_value_of_the_wrong_type_is_refused(tmp_path, value, reason):
    with pytest.raises(InputError, match=r"test\.launch\.py:17") as error:
        parameters(tmp_path, f"[{{'x': {value}}}]")
    assert reason in str(error.value)


def test_files_in_every_form(tmp_path):
    before = "import pathlib\nhere = os.path.dirname(__file__)"
    given = "[here + '/a.yaml', pathlib.Path(here) / 'a.yaml', PathJoinSubstitution([ThisLaunchFileDir(), 'a.yaml']),"
    given += "[ThisLaunchFileDir(), '/a.yaml'], ParameterFile(here + '/a.yaml'), {here + '/a.yaml'},"
    given += "(part for part in (here, '/a.yaml'))]"  # ROS takes any iterable of texts
    (tmp_path / "a.yaml").write_text("")
    assert parameters(tmp_path, given, before) == (tmp_path / "a.yaml",) * 7


def test_a_file_with_substitutions_comes_with_its_text(tmp_path):
    (tmp_path / "a.yaml").write_text("node:\n  ros__parameters:\n    frame: $(var robot)_base # $(var robot)\n")
    given = "[ParameterFile([ThisLaunchFileDir(), '/a.yaml'], allow_substs=True)]"
    text = "node:\n  ros__parameters:\n    frame: r1_base # r1\n"
    assert parameters(tmp_path, given, robot="r1") == (ParameterText(tmp_path / "a.yaml", text),)


def test_a_substitution_in_a_file_that_fails_names_the_file(tmp_path):
    (tmp_path / "a.yaml").write_text("x: $(var robt)\n")
    with pytest.raises(InputError, match=r"a.yaml: launch configuration 'robt' does not exist. Did you mean 'robot'"):
        parameters(tmp_path, "[ParameterFile([ThisLaunchFileDir(), '/a.yaml'], allow_substs=True)]", robot="r1")


def test_a_file_that_was_filled_in_by_hand_is_the_same_file_in_every_run(tmp_path):
    (tmp_path / "a.yaml").write_text("x: $(var robot)\n")
    before = "from launch_ros.parameter_descriptions import ParameterFile\ndef f(context):\n"
    before += "    path = ParameterFile(os.path.dirname(__file__) + '/a.yaml', allow_substs=True).evaluate(context)\n"
    before += "    return [LogInfo(msg=str(path))]"
    paths = [launch_python(tmp_path, "OpaqueFunction(function=f)", before, robot="r1").log[0] for _ in range(2)]
    assert paths[0] == paths[1]
    assert Path(paths[0]).read_text() == "x: r1\n"


def test_a_single_parameter_may_be_given_by_name(tmp_path):
    before = "from launch_ros.parameter_descriptions import Parameter"
    assert parameters(tmp_path, "[Parameter('a', LaunchConfiguration('v'))]", before, v="2") == ({"a": 2},)
