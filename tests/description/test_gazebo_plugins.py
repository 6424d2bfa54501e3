import pytest
from urdf_text import parse_urdf

from drake_twin.description.gazebo_plugins import PluginReader, plugin_kind, plugin_node_name, ros_topic
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.unread import unread_in_urdf
from drake_twin.description.world_file import read_world
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError


def plugin_of(content, attributes='filename="libgazebo_ros_diff_drive.so" name="drive"'):
    text = f'<robot name="r">\n<link name="base"/>\n<gazebo>\n<plugin {attributes}>{content}</plugin></gazebo></robot>'
    (plugin,) = parse_urdf(text).plugins
    return plugin


def test_a_plugins_elements_are_read_as_they_are():
    plugin = plugin_of(
        "<left_joint> a </left_joint><left_joint>b</left_joint><empty/>"
        "<ros><namespace>/ns</namespace><remapping>x:=y</remapping></ros><parameters>one.yaml</parameters>"
    )
    assert plugin.elements == {
        "left_joint": ("a", "b"),
        "empty": ("",),
        "ros/namespace": ("/ns",),
        "ros/remapping": ("x:=y",),
        "parameters": ("one.yaml",),
    }
    assert (plugin.namespace, plugin.parameters, plugin.place.line) == ("/ns", ("one.yaml",), 4)


@pytest.mark.parametrize(
    ("filename", "name", "kind", "node"),
    [
        ("libgazebo_ros_diff_drive.so", "my drive", "gazebo_ros_diff_drive", "my_drive"),
        ("gz-sim-diff-drive-system", "gz::sim::systems::DiffDrive", "diff-drive-system", "diff_drive"),
        ("libgz-sim8-diff-drive-system.so", "gz::sim::systems::DiffDrive", "diff-drive-system", "diff_drive"),
        (
            "ignition-gazebo-diff-drive-system",
            "ignition::gazebo::systems::DiffDrive",
            "diff-drive-system",
            "diff_drive",
        ),
        ("libignition-gazebo6-diff-drive-system.so", "d", "diff-drive-system", "d"),
        ("", "gz::sim::systems::JointStatePublisher", "joint-state-publisher-system", "joint_state_publisher"),
        ("libother.so", "", "libother.so", "libother_so"),
    ],
)
def test_a_plugins_kind_does_not_depend_on_how_its_library_is_written(filename, name, kind, node):
    plugin = GazeboPlugin(filename, name)
    assert (plugin_kind(plugin), plugin_node_name(plugin)) == (kind, node)


@pytest.mark.parametrize(
    ("ros", "topic"),
    [
        ("", "odom"),
        ("<ros><namespace>robot_1</namespace></ros>", "odom"),
        ("<ros><remapping>odom:=odom/unfiltered</remapping></ros>", "odom/unfiltered"),
        ("<ros><remapping>/odom:=/elsewhere</remapping></ros>", "/elsewhere"),
        ("<ros><remapping>cmd_vel:=other</remapping></ros>", "odom"),
        ("<ros><remapping>odom:=~/odom</remapping></ros>", "drive/odom"),
        ("<ros><namespace>/n</namespace><remapping>odom:=/n/wheel_odom</remapping></ros>", "wheel_odom"),
        # /odom is not the topic of a node in a namespace, so this changes nothing
        ("<ros><namespace>n</namespace><argument>--ros-args --remap /odom:=/n/x</argument></ros>", "odom"),
        ("<ros><argument>--ros-args -r __ns:=/a -r odom:=b</argument></ros>", "b"),
    ],
)
def test_topics_follow_the_remappings_of_the_ros_tag(ros, topic):
    assert ros_topic(plugin_of(ros), "odom") == topic


def test_values_are_read_with_checks_that_name_the_line():
    reader = PluginReader(plugin_of("<a>1.5</a><a>2</a><b>one</b><c>nan</c><d>1</d><e>yes</e>"))
    assert reader.numbers("a") == (1.5, 2.0)
    assert reader.number("missing", 7.0) == 7.0
    assert reader.flag("d", False)
    assert not reader.flag("missing", False)
    with pytest.raises(InputError, match=r"<b> is 'one', which is not a number") as error:
        reader.number("b", 0.0)
    assert error.value.line == 4
    with pytest.raises(InputError, match=r"<c> is 'nan', which is not finite"):
        reader.number("c", 0.0)
    with pytest.raises(InputError, match=r"<e> is 'yes', which is neither true nor false"):
        reader.flag("e", False)


@pytest.mark.parametrize(
    ("filename", "name"),
    [
        ("gz-sim-sensors-system", "gz::sim::systems::Sensors"),
        ("libignition-gazebo6-imu-system.so", "ignition::gazebo::systems::Imu"),
        ("", "gz::sim::systems::SceneBroadcaster"),
        ("ignition-gazebo-physics-system", ""),
        ("gz-sim-user-commands-system", "gz::sim::systems::UserCommands"),
        ("libgazebo_ros_state.so", "state"),
        ("gz-sim-forcetorque-system", "gz::sim::systems::ForceTorque"),
    ],
)
def test_what_the_twin_does_by_itself_is_no_finding_in_a_robot_or_a_world(tmp_path, filename, name):
    plugin = f'<plugin filename="{filename}" name="{name}"/>'
    urdf = f'<robot name="r"><link name="l"/><gazebo>{plugin}</gazebo></robot>'
    assert unread_in_urdf(XmlReader(urdf, tmp_path / "r.urdf")) == []
    (tmp_path / "w.sdf").write_text(f'<sdf version="1.9"><world name="w">{plugin}</world></sdf>')
    assert read_world(str(tmp_path / "w.sdf"), PackageIndex((), {})).findings == ()
