"""A free place for a robot: beside what is there, in what is hollow, on what is a floor."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import rovers

from drake_twin.diagram.footprint import Footprint
from drake_twin.diagram.free_place import Area, area_of, free_place, taken_areas
from drake_twin.scenario import World
from drake_twin.twin.twin import Twin

SMALL = Area((-0.2, -0.1), (0.2, 0.1))


def test_the_place_itself_where_nothing_is():
    assert free_place(SMALL, [], (3.0, -1.0)) == (3.0, -1.0)


def test_the_nearest_free_place_with_some_room_between():
    taken = [Area((-0.5, -0.5), (0.5, 0.5)), Area((-0.5, 0.5), (0.5, 1.5))]
    x, y = free_place(SMALL, taken, (0.0, 0.0))
    assert (x, y) != (0.0, 0.0)
    assert not any(SMALL.moved(x, y).is_near(area, 0.29) for area in taken)
    assert np.hypot(x, y) < 1.5


def test_a_turned_robot_takes_what_its_corners_reach():
    box = Footprint((-1.0, -0.5, 0.0), (3.0, 0.5, 1.0))
    assert area_of(box) == Area((-1.0, -0.5), (3.0, 0.5))
    turned = area_of(box, np.pi / 2)
    assert (*turned.lower, *turned.upper) == pytest.approx((-0.5, -1.0, 0.5, 3.0))


WORLD = """<sdf version="1.9"><world name="w">
<model name="floor"><static>true</static><pose>0 0 -0.05 0 0 0</pose><link name="l"><collision name="c"><geometry><box>
  <size>30 30 0.1</size></box></geometry></collision></link></model>
<model name="hall"><static>true</static><pose>0 0 2 0 0 0</pose><link name="l"><collision name="c"><geometry><box>
  <size>20 20 0.1</size></box></geometry></collision></link></model>
<model name="wall"><static>true</static><pose>0 2 0.5 0 0 0</pose><link name="l"><collision name="c"><geometry><box>
  <size>4 0.2 1</size></box></geometry></collision></link></model>
</world></sdf>"""


def test_floors_and_the_hall_around_a_robot_take_nothing_and_walls_do(tmp_path):
    (tmp_path / "w.sdf").write_text(WORLD)
    scenario = replace(rovers(1).scenario(), world=World(file=str(tmp_path / "w.sdf")))
    with Twin(scenario) as twin:
        scene_graph = twin.diagram.GetSubsystemByName("scene_graph")
        query = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(twin.context))
        taken = taken_areas(query, [(0.0, 0.0)])
    wide = {tuple(np.round([*area.lower, *area.upper], 6)) for area in taken if area.upper[0] - area.lower[0] > 1}
    assert wide == {(-2.0, 1.9, 2.0, 2.1)}
    assert any(area.has(0.0, 0.0) for area in taken)  # the rover
