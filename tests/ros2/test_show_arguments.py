from launch_files import write, write_package, write_python

from drake_twin.description.package_index import PackageIndex
from drake_twin.ros2.evaluate import declared_arguments


def arguments(file, **given):
    return {item.name: item for item in declared_arguments(file, PackageIndex([file.parent]), given)}


def test_arguments_come_with_default_description_and_choices(tmp_path):
    file = write_python(
        tmp_path / "x.launch.py",
        """DeclareLaunchArgument("model", default_value=[FindPackageShare("p"), "/m.xacro"], description="the robot"),
        DeclareLaunchArgument("mode", default_value="a", choices=["a", "b"]), DeclareLaunchArgument("needed"),""",
    )
    found = arguments(file)
    assert list(found) == ["model", "mode", "needed"]
    assert found["model"].default == "FindPkgShare(pkg='p')/m.xacro"
    assert found["model"].description == "the robot"
    assert found["mode"].choices == ("a", "b")
    assert found["needed"].default is None
    assert str(found["needed"].place) == f"{file}:18"


def test_arguments_of_includes_are_shown_but_not_those_they_are_given(tmp_path):
    package = write_package(tmp_path, "robots")
    write(package / "a.launch.xml", '<launch><arg name="x" default="1"/><arg name="y" default="2"/></launch>')
    file = write(
        tmp_path / "x.launch.xml",
        """<launch><arg name="which" default="a"/><group if="false">
        <include file="$(find-pkg-share robots)/$(var which).launch.xml"><arg name="x" value="5"/></include></group>
        <include file="$(find-pkg-share ros_gz_sim)/launch/gz_sim.launch.py"/>
        <include file="$(find-pkg-share gone)/launch/x.launch.py"/></launch>""",
    )
    found = arguments(file)
    assert list(found)[:2] == ["which", "y"]
    assert "gz_args" in found


def test_a_value_decides_which_file_is_included(tmp_path):
    write(tmp_path / "a.launch.xml", '<launch><arg name="of_a"/></launch>')
    write(tmp_path / "b.launch.xml", '<launch><arg name="of_b"/></launch>')
    file = write(
        tmp_path / "x.launch.xml",
        '<launch><arg name="which" default="a"/><include file="$(dirname)/$(var which).launch.xml"/></launch>',
    )
    assert list(arguments(file)) == ["which", "of_a"]
    assert list(arguments(file, which="b")) == ["which", "of_b"]


def test_nothing_is_started_to_show_arguments(tmp_path):
    file = write_python(
        tmp_path / "x.launch.py",
        "DeclareLaunchArgument('a', default_value='1'), OpaqueFunction(function=lambda context: 1 / 0)",
    )
    assert list(arguments(file)) == ["a"]


def test_files_that_include_each_other_come_to_an_end(tmp_path):
    write(tmp_path / "b.launch.xml", '<launch><arg name="b"/><include file="$(dirname)/a.launch.xml"/></launch>')
    file = write(tmp_path / "a.launch.xml", '<launch><arg name="a"/><include file="$(dirname)/b.launch.xml"/></launch>')
    assert list(arguments(file)) == ["a", "b"]


def test_the_arguments_of_the_file_itself_come_first(tmp_path):
    write(tmp_path / "inner.launch.xml", '<launch><arg name="inner" default="1"/></launch>')
    include = '<include file="$(dirname)/inner.launch.xml"/>'
    file = write(tmp_path / "outer.launch.xml", f'<launch>{include}<arg name="outer" default="2"/></launch>')
    assert [argument.name for argument in declared_arguments(file)] == ["outer", "inner"]
