import pytest
import umsgpack
from conftest import ARM

from drake_twin import Twin, TwinBuilder
from drake_twin.cockpit.joint_viewer import JointViewer
from drake_twin.cockpit.page import open_meshcat


@pytest.fixture(scope="module")
def shown():
    meshcat = open_meshcat()
    twin = Twin(TwinBuilder().robot("arm", ARM).scenario(), meshcat)
    return meshcat, twin, JointViewer(meshcat, twin)


def test_each_joint_that_follows_nothing_has_a_slider(shown):
    meshcat, _, _ = shown
    assert meshcat.GetSliderNames() == ["joint_1", "joint_2", "joint_3", "joint_4"]


def test_a_slider_moves_its_joint_and_the_joints_that_follow_it(shown):
    meshcat, twin, viewer = shown
    message = {"type": "slider", "name": "joint_4", "value": 0.3}
    meshcat._InjectWebsocketMessage(message=umsgpack.packb(message))
    viewer.obey()
    assert twin.robot_state("arm").positions[-2:] == pytest.approx((0.3, -0.3))
    assert twin.time == 0


def test_a_sliders_range_is_the_joints_own(tmp_path):
    file = tmp_path / "slide.urdf"
    inertial = '<inertial><mass value="1"/></inertial>'
    file.write_text(
        f'<robot name="s"><link name="world"/><link name="a">{inertial}</link><joint name="j" type="prismatic"><parent'
        ' link="world"/><child link="a"/><limit lower="2" upper="3"/></joint></robot>'
    )
    meshcat = open_meshcat()
    twin = Twin(TwinBuilder().robot("s", file).scenario(), meshcat)
    viewer = JointViewer(meshcat, twin)
    meshcat._InjectWebsocketMessage(message=umsgpack.packb({"type": "slider", "name": "j", "value": 2.75}))
    viewer.obey()
    assert twin.robot_state("s").positions == pytest.approx((2.75,))
