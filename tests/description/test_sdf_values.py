import pytest

from drake_twin import TwinBuilder
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.errors import InputError

SDF = """<sdf version="1.9"><model name="m">
<link name="a"><inertial><mass>1</mass></inertial><collision name="c"><geometry><box><size>1 1 1</size></box></geometry>
<surface><friction><ode><mu>0.5</mu></ode></friction></surface></collision>
<visual name="v">
<geometry><box><size>1 1 1</size></box></geometry><material><diffuse>1 0 0</diffuse></material></visual>
</link>
<link name="b"><pose>0 0 1 0 0 0</pose></link>
<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>
</model></sdf>"""


def load(tmp_path, text):
    (tmp_path / "m.sdf").write_text(text)
    return load_robot_model(str(tmp_path / "m.sdf"), PackageIndex((), {}))


def test_a_model_of_numbers_has_no_finding(tmp_path):
    assert load(tmp_path, SDF).findings == ()


@pytest.mark.parametrize(
    ("right", "wrong", "line", "what"),
    [
        ("0.5", "0.5..", 3, "<mu> of <ode> is '0.5..', which is not a number: Gazebo refuses it"),
        ("0.5", "0.5 1", 3, "<mu> of <ode> is '0.5 1', where one number is needed: Gazebo refuses it"),
        ("0.5", "-1", 3, "<mu> of <ode> is '-1', which cannot be negative: Gazebo refuses it"),
        ("0.5", "", 3, "<mu> of <ode> is '', where one number is needed: Gazebo refuses it"),
        (
            "1 0 0<",
            "1 nan 0<",
            5,
            "<diffuse> of <material> is '1 nan 0', where 'nan' is not a number: Gazebo refuses it",
        ),
    ],
)
def test_a_value_that_is_not_as_many_numbers_is_a_finding_with_its_line(tmp_path, right, wrong, line, what):
    (finding,) = load(tmp_path, SDF.replace(right, wrong)).findings
    assert (finding.what, finding.lines) == (what, (line,))


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [
        ("<parent>a", "<parent>x", 8),  # names the joint
        ('link name="b"', 'link name="a"', 7),  # says that a name is there twice
        ("<pose>0 0 1", "<pose>0 0 abc", 7),  # has the path of the element
        (' version="1.9"', "", 1),
    ],
)
def test_what_drakes_reader_refuses_has_a_line(tmp_path, right, wrong, line):
    text = SDF.replace(right, wrong)
    with pytest.raises(InputError, match=rf"^{tmp_path}/m.sdf:{line}: ") as refused:
        load(tmp_path, text)
    assert "\n" not in str(refused.value)


def test_a_number_at_which_drakes_own_code_fails_is_told(tmp_path):
    text = SDF.replace("</xyz></axis>", "</xyz><limit>\n<lower>nan</lower></limit></axis>")
    with pytest.raises(InputError) as refused:
        load(tmp_path, text)
    what = "<lower> of <limit> is 'nan', which is not a number: Gazebo refuses it"
    assert str(refused.value) == f"{tmp_path}/m.sdf:9: {what}."


def test_a_frame_that_the_model_lacks_has_the_line_that_names_it(tmp_path):
    (tmp_path / "m.sdf").write_text(SDF.replace('<link name="b">', '<link name="b"><pose relative_to="x"/>'))
    with pytest.raises(InputError, match=rf"^{tmp_path}/m.sdf:7: "):
        TwinBuilder().robot("r", tmp_path / "m.sdf").build()
