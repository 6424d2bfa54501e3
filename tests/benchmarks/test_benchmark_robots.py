"""Robots for engines without ROS: the joints that are commanded, and the friction of their tires."""

import pytest

from drake_twin.benchmarks.boxes import FRICTION
from drake_twin.benchmarks.robots import prepare
from drake_twin.benchmarks.workloads import WORKLOADS
from drake_twin.builder.demo import demo_scenario


@pytest.fixture
def prepared(tmp_path):
    return prepare(WORKLOADS["cruising rovers"], 2, tmp_path, 0.001)


def test_each_robot_has_its_four_wheels_with_their_efforts(prepared):
    assert [len(robot.joints) for robot in prepared.robots] == [4, 4]
    assert prepared.positions.shape == (2, 4)
    assert len(set(prepared.positions.ravel().tolist())) == 8
    for joint in prepared.robots[1].joints:
        assert joint.name.startswith("robot_2_") or "wheel" in joint.name
        assert joint.effort > 0
    assert "drake:" not in prepared.robots[0].urdf


def test_robots_stand_where_the_demo_has_them(prepared):
    places = [robot.xyz for robot in demo_scenario("rover", 2).robots]
    assert [robot.xyz for robot in prepared.robots] == places
    assert places[0] != places[1]


def test_the_other_engines_tires_have_the_twins_friction(prepared):
    """Gazebo has the smaller friction of two shapes, and so do these wheels on this ground."""
    parts, inspector = prepared.parts, prepared.parts.scene_graph.model_inspector()
    frictions = {
        inspector.GetProximityProperties(geometry).GetProperty("material", "coulomb_friction").static_friction()
        for index in parts.plant.GetBodyIndices(parts.robots["robot_1"].instance)
        for geometry in parts.plant.GetCollisionGeometriesForBody(parts.plant.get_body(index))
        if "wheel" in parts.plant.get_body(index).name()
    }
    assert frictions == {FRICTION}
