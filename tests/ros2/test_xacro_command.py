"""The command xacro in launch files: which uses are expanded here, and what is wrong with a file."""

import pytest
from launch_files import write

from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.xacro_command import run_xacro

ROBOT = """<robot name="it" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="side" default="left"/>
<link name="$(arg side)_base"/></robot>"""


@pytest.fixture
def file(tmp_path):
    return write(tmp_path / "it.urdf.xacro", ROBOT)


@pytest.mark.parametrize(("words", "link"), [((), "left_base"), (("side:=right",), "right_base")])
@pytest.mark.parametrize("options", [(), ("--inorder",), ("-q", "-i")])
def test_a_file_is_expanded_with_its_arguments(file, words, link, options):
    text, warnings = run_xacro(["/opt/ros/bin/xacro", *options, str(file), *words], LaunchContext())
    assert f'<link name="{link}"/>' in text
    assert "xacro" not in text.partition("<robot")[2]
    assert warnings == ""


@pytest.mark.parametrize("words", [["cat", "FILE"], ["xacro", "FILE", "FILE"], ["xacro", "--deps", "FILE"], ["xacro"]])
def test_another_use_is_not_expanded_here(file, words):
    assert run_xacro([word.replace("FILE", str(file)) for word in words], LaunchContext()) is None


def test_a_file_that_is_missing_or_wrong_is_an_error(tmp_path):
    with pytest.raises(InputError, match=r"the xacro file .*none.xacro does not exist"):
        run_xacro(["xacro", str(tmp_path / "none.xacro")], LaunchContext())
    wrong = write(tmp_path / "wrong.xacro", ROBOT.replace("$(arg side)", "$(arg what)"))
    with pytest.raises(InputError, match="what"):
        run_xacro(["xacro", str(wrong)], LaunchContext())
