"""Which links the wind pushes, by ``<enable_wind>`` of URDF and SDF."""

import pytest
from lxml import etree
from sdf_worlds import BOX, findings, world_of

from drake_twin.description.link_wind import windy_links_of_sdf, windy_links_of_urdf
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model

WINDY = "<enable_wind>true</enable_wind>"
LINKS = """<link name="base"/><link name="plate"/><link name="wheel"/>
<joint name="p" type="fixed"><parent link="base"/><child link="plate"/></joint>
<joint name="w" type="continuous"><parent link="base"/><child link="wheel"/></joint>"""


@pytest.mark.parametrize(
    ("tags", "windy"),
    [
        ("", ()),
        (f'<gazebo reference="wheel">{WINDY}</gazebo>', ("wheel",)),
        (f'<gazebo reference="plate">{WINDY}</gazebo>', ("base", "plate")),  # which Gazebo folds together
        ('<gazebo reference="base"><enable_wind value="1"/></gazebo>', ("base", "plate")),
        ("<gazebo><enable_wind>0</enable_wind></gazebo>", ()),
        (f"<gazebo>{WINDY}</gazebo>", ("base", "plate", "wheel")),
    ],
)
def test_of_a_urdf(tags, windy):
    assert windy_links_of_urdf(etree.fromstring(f'<robot name="r">{LINKS}{tags}</robot>')) == windy


def test_of_an_sdf_with_models_inside():
    inner = (
        f'<model name="in">{WINDY}<link name="x"/><link name="y"/></model><model name="calm"><link name="z"/></model>'
    )
    model = etree.fromstring(f'<model name="m"><link name="a">{WINDY}</link><link name="b"/>{inner}</model>')
    assert tuple(windy_links_of_sdf(model)) == ("a", "in::x", "in::y")


def test_models_of_a_world_tell_theirs_and_nothing_is_ignored(tmp_path):
    model = f'<model name="m">{WINDY}{BOX}</model><model name="still"><static>1</static>{WINDY}{BOX}</model>'
    world = world_of(tmp_path, model)
    assert [model.windy_links for model in world.models] == [("link",), ()]
    assert findings(world) == ()


def test_a_robot_with_models_inside_tells_their_links_as_its_own(tmp_path):
    joint = '<joint name="j" type="fixed"><parent>link</parent><child>in::link</child></joint>'
    text = f'<sdf version="1.9"><model name="r">{BOX}<model name="in">{WINDY}{BOX}</model>{joint}</model></sdf>'
    (tmp_path / "r.sdf").write_text(text)
    model = load_robot_model(str(tmp_path / "r.sdf"), PackageIndex(()))
    assert model.description.windy_links == ("in_link",)
    assert model.findings == ()


def test_another_word_is_told(tmp_path):
    text = f'<sdf version="1.9"><model name="r"><enable_wind>yes</enable_wind>{BOX}</model></sdf>'
    (tmp_path / "r.sdf").write_text(text)
    model = load_robot_model(str(tmp_path / "r.sdf"), PackageIndex(()))
    assert [item.what for item in model.findings] == [
        "<enable_wind> is 'yes', which is neither true nor false: it counts as false"
    ]
    assert model.description.windy_links == ()
