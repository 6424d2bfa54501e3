"""Poses that are relative to frames that the model does not have, which Gazebo takes as relative to the link."""

import pytest
from lxml import etree
from sdf_worlds import findings, world_of

from drake_twin import TwinBuilder
from drake_twin.description.sdf_unknown_frames import forget_unknown_frames

INERTIAL = "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
LIDAR = """<sensor name="s" type="gpu_lidar">
  <pose relative_to="{}">0 0 0.5 0 0 0</pose><ray><scan><horizontal><samples>1</samples><min_angle>0</min_angle>
  <max_angle>0</max_angle></horizontal></scan><range><min>0.1</min><max>9</max></range></ray></sensor>"""


SAID = "its pose is relative to the unknown frame 'gone'; it is taken as relative to the link 'l', as in Gazebo"


def changed(inside):
    model = etree.fromstring(f'<model name="m">{inside}</model>')
    said = [what for _, what in forget_unknown_frames(model)]
    return [pose.get("relative_to") for pose in model.iter("pose")], said


@pytest.mark.parametrize("holder", ["sensor", "collision", "visual"])
def test_what_a_link_holds_stays_with_the_link(holder):
    pose = '<pose relative_to="gone">1 0 0 0 0 0</pose>'
    assert changed(f'<link name="l"><{holder} name="h">{pose}</{holder}></link>') == (
        [None],
        [f"{holder} 'h': {SAID}"],
    )


@pytest.mark.parametrize("frame", ["l", "j", "f", "inner", "inner::k", "__model__", "inner::__model__"])
def test_frames_of_the_model_and_of_those_inside_it_stay(frame):
    others = '<joint name="j"/><frame name="f"/><model name="inner"><link name="k"/></model>'
    held = f'<link name="l"><sensor name="s"><pose relative_to="{frame}">1 0 0 0 0 0</pose></sensor></link>'
    assert changed(held + others) == ([frame], [])


@pytest.mark.parametrize("frame", ["inner::gone", "gone::k", "k"])
def test_a_model_inside_has_frames_of_its_own(frame):
    others = '<model name="inner"><link name="k"/></model>'
    held = f'<joint name="j"><sensor name="s"><pose relative_to="{frame}">1 0 0 0 0 0</pose></sensor></joint>'
    assert changed(held + others)[0] == [None]
    assert "relative to the joint 'j'" in changed(held + others)[1][0]


def test_a_robot_with_such_a_lidar_runs_and_measures_from_its_link(tmp_path):
    """Looking down from 0.5 m above the link, which is held 1 m above the ground."""
    file = tmp_path / "mast.sdf"
    lidar = LIDAR.format("gone").replace("0 0 0.5 0 0 0", "0 0 0.5 0 1.5707963267948966 0")
    link = f"<link name='l'>{INERTIAL}{lidar}</link>"
    file.write_text(f"<sdf version='1.9'><model name='mast'><static>true</static>{link}</model></sdf>")
    twin = TwinBuilder().robot("mast", file, xyz=(0, 0, 1)).build()
    ranges = []
    twin.subscribe("/mast/s/scan", lambda message: ranges.append(message.ranges[0]))
    twin.advance_to(0.01)
    assert ranges[0] == pytest.approx(1.5, abs=1e-3)
    (said,) = [str(finding) for finding in twin.findings if "unknown frame" in finding.what]
    assert "mast.sdf:2" in said


def test_a_model_of_a_world_is_read_likewise(tmp_path):
    link = f'<link name="l">{INERTIAL}{LIDAR.format("gone")}</link>'
    world = world_of(tmp_path, f'<model name="mast"><static>true</static>{link}</model>')
    assert [what for what in findings(world) if "unknown frame 'gone'" in what]
