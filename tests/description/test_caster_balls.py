import pytest
from lxml import etree
from sdf_worlds import findings, world_of

SLIDES = "m: joint j: its caster ball slides without friction instead of rolling"
SPHERE = "<collision name='c'>{}<geometry><sphere><radius>0.05</radius></sphere></geometry>{}</collision>"
ROUGH = "<surface><friction><ode><mu>0.7</mu><mu2>0.7</mu2></ode></friction></surface>"


def model(shapes, *, joint="", link="", more="", tmp_path):
    """A model with a ball joint, as it goes to Drake, and what was said of it."""
    world = world_of(
        tmp_path,
        f"""<model name="m"><link name="base"/><link name="ball">{link}{shapes}</link>{more}
<joint name="j" type="ball"><parent>base</parent><child>ball</child>{joint}</joint></model>""",
    )
    return etree.fromstring(world.models[0].text).find("model"), findings(world)


CASTERS = {
    "plain": {"shapes": SPHERE.format("", ROUGH)},
    "off the link": {
        "shapes": SPHERE.format("<pose>0 0.1 0 0 0 0</pose>", ""),
        "joint": "<pose relative_to='ball'>0 0.1 0.0009 0 0 0</pose>",
    },
    "a link placed by its joint": {
        "shapes": SPHERE.format("<pose>0 0 0.1 0 0 0</pose>", ROUGH),
        "joint": "<pose relative_to='base'>1 0 0 0 0 0</pose>",
        "link": "<pose relative_to='j'>0 0.1 0 1.5707963267948966 0 0</pose>",
    },
    "two spheres": {"shapes": SPHERE.format("", ROUGH) + SPHERE.format("", ROUGH).replace("'c'", "'d'")},
}


@pytest.mark.parametrize("case", CASTERS)
def test_a_sphere_about_a_ball_joint_is_welded_on_as_a_frictionless_point_of_mass(tmp_path, case):
    inertial = "<inertial><mass>0.2</mass><inertia><ixx>3</ixx><iyy>3</iyy><izz>3</izz></inertia></inertial>"
    parts = CASTERS[case]
    found, warnings = model(**{**parts, "link": parts.get("link", "") + inertial}, tmp_path=tmp_path)
    assert warnings == (SLIDES,)
    assert found.find("joint").get("type") == "fixed"
    frictions = [float(item.text) for item in found.iterfind("link/collision/{*}proximity_properties/*")]
    assert set(frictions) == {0.0}
    assert found.findtext("link/inertial/mass") == "0.2"
    assert [item.text for item in found.find("link/inertial/inertia")] == ["0", "0", "0"]


BOX = "<collision name='b'><geometry><box><size>1 1 1</size></box></geometry></collision>"
OTHERS = {
    "no shape": {"shapes": ""},
    "a box beside it": {"shapes": SPHERE.format("", "") + BOX},
    "off the centre": {"shapes": SPHERE.format("<pose>0 0.0011 0 0 0 0</pose>", "")},
    "it carries a link": {
        "shapes": SPHERE.format("", ""),
        "more": """<link name="hand"/>
<joint name="k" type="fixed"><parent>ball</parent><child>hand</child></joint>""",
    },
    "in another frame": {
        "shapes": SPHERE.format("<pose relative_to='base'>0 0 0 0 0 0</pose>", ""),
    },
}


@pytest.mark.parametrize("case", OTHERS)
def test_any_other_ball_joint_stays(tmp_path, case):
    found, warnings = model(**OTHERS[case], tmp_path=tmp_path)
    assert warnings == ()
    assert found.find("joint[@name='j']").get("type") == "ball"
