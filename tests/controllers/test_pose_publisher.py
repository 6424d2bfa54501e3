"""gz-sim's PosePublisher: which poses its source publishes, in which frames."""

from math import cos, pi, sin

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import ROBOT, Running, setup_of

from drake_twin import TwinBuilder
from drake_twin.controllers.pose_publisher import PosePublisher
from drake_twin.description.gazebo_drive import POSE_PUBLISHER

POSES = np.arange(28.0).reshape(4, 7)
LINKS = [("hand", f"hand/{link}") for link in ROBOT.links]


def publisher(**given):
    parameters = parameters_of(POSE_PUBLISHER, **given)
    run = PosePublisher(setup_of(PosePublisher, parameters, robot="hand"))
    return Running(run, poses=POSES.ravel()[: run.num_values()])


def frames_of(message):
    return [(item.header.frame_id, item.child_frame_id) for item in message.transforms]


def values_of(item):
    place, turned = item.transform.translation, item.transform.rotation
    return [place.x, place.y, place.z, turned.x, turned.y, turned.z, turned.w]


def test_links_are_published_in_the_models_frame():
    run = publisher()
    run.advance(0.5)
    message = run.output("pose")
    assert frames_of(message) == LINKS
    assert [values_of(item) for item in message.transforms] == POSES[:3].tolist()
    assert {item.header.stamp.nanosec for item in message.transforms} == {500_000_000}


def test_the_model_comes_first_or_alone():
    both = publisher(publish_model_pose=True).output("pose")
    assert frames_of(both) == [("world", "hand"), *LINKS]
    alone = publisher(publish_model_pose=True, publish_link_pose=False).output("pose")
    assert frames_of(alone) == [("world", "hand")]
    assert values_of(alone.transforms[0]) == POSES[0].tolist()


def test_nothing_to_publish_is_a_problem_and_an_inactive_one_has_no_message():
    nothing = parameters_of(POSE_PUBLISHER, publish_link_pose=False)
    assert PosePublisher.problem(nothing, ROBOT) == "it publishes no pose"
    run = publisher()
    run.controller.deactivate(run.context)
    assert run.output("pose") is None


# The root link stands .3 m ahead of the model's frame, its arm turns about y at (.3, 0, .5).
SDF = """<sdf version="1.9"><model name="m"><link name="root"><pose>0.3 0 0 0 0 0</pose></link>
<link name="arm"><pose>0.3 0 0.5 0 0 0</pose></link>
<joint name="j" type="revolute"><parent>root</parent><child>arm</child><axis><xyz>0 1 0</xyz></axis></joint>
<plugin filename="gz-sim-pose-publisher-system" name="gz::sim::systems::PosePublisher">
<publish_nested_model_pose>true</publish_nested_model_pose><use_pose_vector_msg>true</use_pose_vector_msg>
<update_frequency>20</update_frequency></plugin></model></sdf>"""


def test_in_the_twin_the_models_frame_is_not_the_root_links(tmp_path):
    (tmp_path / "m.sdf").write_text(SDF)
    twin = TwinBuilder().robot("m", tmp_path / "m.sdf", xyz=(1, 2, 3), initial_positions={"j": pi / 2}).build()
    assert [str(finding) for finding in twin.findings if "plugin" in str(finding)] == []
    message = twin.latest("/m/pose")
    assert frames_of(message) == [("world", "m"), ("m", "m/root"), ("m", "m/arm")]
    model, root, arm = map(values_of, message.transforms)
    assert model == pytest.approx([1, 2, 3, 0, 0, 0, 1])
    assert root == pytest.approx([0.3, 0, 0, 0, 0, 0, 1])
    assert arm == pytest.approx([0.3, 0, 0.5, 0, sin(pi / 4), 0, cos(pi / 4)])
