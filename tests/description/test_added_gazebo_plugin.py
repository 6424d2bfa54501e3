"""A Gazebo plugin of another package, from its registration to the joint that it turns."""

import pytest

from drake_twin.builder.twin_builder import TwinBuilder
from drake_twin.description.gazebo_drive import GAZEBO_PLUGINS, DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.errors import InputError

SPINNER = """<robot name="spinner"><link name="base"/>
<link name="rotor"><inertial><mass value="1"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="turn" type="continuous"><axis xyz="0 0 1"/><parent link="base"/><child link="rotor"/></joint>
<gazebo><plugin filename="libmy_spinner.so" name="my_spinner"><joint>turn</joint><colour>red</colour></plugin></gazebo>
</robot>"""


def my_spinner(plugin: DrivePlugin) -> GazeboDrive:
    joints = plugin.joints("joint")
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("velocity_controllers/JointGroupVelocityController", {"joints": list(joints)}),
        topics=plugin.ros_topics({"commands": "spin"}),
        interfaces=tuple((joint, "velocity") for joint in joints),
    )


@pytest.fixture
def spinner(tmp_path):
    file = tmp_path / "spinner.urdf"
    file.write_text(SPINNER)
    return TwinBuilder().robot("s", file)


@pytest.fixture
def added(monkeypatch):
    monkeypatch.setattr(GAZEBO_PLUGINS, "_kinds", GAZEBO_PLUGINS._kinds.new_child())
    gazebo_plugin("libmy_spinner.so")(my_spinner)


def test_the_plugin_turns_its_joint(added, spinner):
    twin = spinner.build()
    twin.publish("/s/spin", [2.0])
    twin.step(500)
    assert twin.joint_states("s").velocity[0] == pytest.approx(2.0, abs=0.01)
    assert "<colour> of Gazebo plugin my_spinner" in " ".join(map(str, twin.findings))


def test_without_it_the_plugin_is_ignored(spinner):
    findings = " ".join(map(str, spinner.build().findings))
    assert "Gazebo plugin my_spinner (libmy_spinner.so): the twin has no such plugin" in findings


def test_one_plugin_has_one_function(added):
    with pytest.raises(InputError, match=r"Gazebo plugin 'libmy_spinner\.so' is registered by \w+ and by \w+"):
        gazebo_plugin("libmy_spinner.so")(lambda plugin: GazeboDrive(plugin.plugin))
