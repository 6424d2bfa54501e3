"""Node programs find the packages of their workspace, with their messages and their files."""

import pytest
from interface_packages import write_package
from node_scripts import run_script

from drake_twin.nodes.package_folders import PackageFolders
from drake_twin.ros2.ament_index_python.packages import PackageNotFoundError


def test_a_workspace(tmp_path, capsys):
    package = write_package(tmp_path / "src", "some_rover", msg={"Mode": "uint8 FAST=2\nuint8 mode 1\n"})
    (package / "some_rover").mkdir()
    (package / "some_rover" / "__init__.py").write_text("")
    (package / "some_rover" / "modes.py").write_text("from some_rover.msg import Mode\nfast = Mode(mode=Mode.FAST)\n")
    (package / "config").mkdir()
    (package / "config" / "speeds.yaml").write_text("fast: 2\n")
    scripts = package / "scripts"
    scripts.mkdir()
    text = """
import os
import rclpy
from ament_index_python.packages import PackageNotFoundError, get_package_prefix, get_package_share_directory
from rclpy.node import Node
from some_rover.modes import fast
from some_rover.msg import Mode

share = get_package_share_directory("some_rover")
print(open(os.path.join(share, "config", "speeds.yaml")).read().strip())
assert os.path.samefile(os.path.join(get_package_prefix("some_rover"), "share", "some_rover"), share)
try:
    get_package_share_directory("nowhere_to_be_found")
except PackageNotFoundError as error:
    print("absent", isinstance(error, KeyError))
rclpy.init()
node = Node("modes")
heard = []
node.create_subscription(Mode, "mode", heard.append, 3)
publisher = node.create_publisher(Mode, "mode", 3)
publisher.publish(fast)
while not heard:
    rclpy.spin_once(node)
print("heard", heard[0])
"""
    assert run_script(scripts, text) == ""
    lines = capsys.readouterr().out.splitlines()
    assert "fast: 2" in lines
    assert "absent True" in lines
    assert "heard some_rover.msg.Mode(mode=2)" in lines


def test_a_wrong_file_is_told_with_its_line(tmp_path):
    package = write_package(tmp_path / "src", "wrong_rover_msgs", msg={"Mode": "uint8 fine\nuint9 wrong\n"})
    found = run_script(package, "from wrong_rover_msgs.msg import Mode\n", 0.1)
    assert f"{package}/msg/Mode.msg:2: " in found
    assert "uint9" in found
    assert f"{package}/script.py:1" in found


def test_other_modules_are_left_alone():
    folders = PackageFolders({}.get)
    assert folders.source("ament_index_python.other") is None
    assert folders.source("ament_index_python").PackageNotFoundError is PackageNotFoundError


def installed(prefix, kind, name, content):
    file = prefix / "share" / "ament_index" / "resource_index" / kind / name
    file.parent.mkdir(parents=True)
    file.write_text(content)


def test_resources_of_the_workspace_and_of_installed_ones(tmp_path, monkeypatch):
    """A package of the workspace is a resource of the type ``packages``; installed prefixes have the others."""
    share, prefix = tmp_path / "ws" / "share" / "rover", tmp_path / "installed"
    installed(prefix, "plugins", "rover", "rover.xml")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{prefix}:{tmp_path / 'gone'}")
    folders = PackageFolders({"rover": share}.get)
    index = folders.source("ament_index_python.resources")
    assert index.get_search_paths() == [str(prefix)]
    assert index.get_resource("packages", "rover") == ("", str(tmp_path / "ws"))
    assert index.get_resource("plugins", "rover") == ("rover.xml", str(prefix))
    assert index.has_resource("plugins", "other") is False
    assert index.get_resources("packages") == {"rover": str(tmp_path / "ws")}
    assert index.get_resources("plugins") == {"rover": str(prefix)}
    assert index.get_resource_types() == {"packages", "plugins"}
    with pytest.raises(LookupError, match="Could not find the resource 'other' of type 'plugins'"):
        index.get_resource("plugins", "other")
    with pytest.raises(index.InvalidResourceNameError, match=r"'\.\./x' is invalid"):
        index.has_resource("plugins", "../x")
    with pytest.raises(index.InvalidResourceTypeNameError, match="'a/b' is invalid"):
        index.get_resources("a/b")


def test_a_module_of_another_name_than_its_package(tmp_path, capsys):
    """ROS finds it wherever a package of the workspace installs it."""
    package = write_package(tmp_path / "src", "arm_tools")
    (package / "CMakeLists.txt").write_text(
        "project(arm_tools)\nament_python_install_package(reach PACKAGE_DIR code)\n"
    )
    (package / "code").mkdir()
    (package / "code" / "__init__.py").write_text("LENGTH = 0.7\n")
    (package / "code" / "far.py").write_text("from reach import LENGTH\nFAR = 2 * LENGTH\n")
    other = write_package(tmp_path / "src", "arm_bringup") / "scripts"
    other.mkdir()
    run_script(other, "from reach.far import FAR\nprint(FAR)\n")
    assert capsys.readouterr().out.split() == ["1.4"]


def test_a_program_with_a_launch_description_in_its_file(tmp_path, capsys):
    """As those of py_trees_ros_tutorials: ``ros2 launch`` and ``ros2 run`` read the same module."""
    text = """
import launch, launch_ros.actions
from launch.actions import DeclareLaunchArgument

def generate_launch_description():
    node = launch_ros.actions.Node(package="a", executable="b")
    return launch.LaunchDescription([DeclareLaunchArgument("speed"), node])

print([type(each).__name__ for each in generate_launch_description().entities])
try:
    import launch.actions.no_such_action
except ModuleNotFoundError as error:
    print(error)
"""
    assert run_script(tmp_path, text) == ""
    said = capsys.readouterr().out.splitlines()
    assert said == ["['DeclareLaunchArgument', 'Node']", "No module named 'launch.actions.no_such_action'"]


def test_resources_are_packages_and_what_is_installed_beside_them(tmp_path):
    share = tmp_path / "install" / "mine" / "share"
    (share / "mine").mkdir(parents=True)
    entry = share / "ament_index" / "resource_index" / "rviz_common__pluginlib__plugin" / "mine"
    entry.parent.mkdir(parents=True)
    entry.write_text("share/mine/plugins.xml")
    folders = PackageFolders({"mine": share / "mine"}.get)
    module = folders.source("ament_index_python.resources")
    assert not hasattr(module, "get_package_prefix")
    prefix = str(share.parent)
    assert module.get_resource("packages", "mine") == ("", prefix)
    assert module.get_resource("rviz_common__pluginlib__plugin", "mine") == ("share/mine/plugins.xml", prefix)
    assert (module.has_resource("packages", "other"), module.has_resource("plugins", "mine")) == (False, False)
    with pytest.raises(LookupError, match="Could not find the resource 'mine' of type 'plugins'"):
        module.get_resource("plugins", "mine")
    packages = folders.source("ament_index_python")
    packages.get_package_share_path("mine")
    assert (packages.get_resources("packages"), packages.get_resources("plugins")) == ({"mine": prefix}, {})
