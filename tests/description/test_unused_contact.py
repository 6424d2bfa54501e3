import pytest

from drake_twin import TwinBuilder
from drake_twin.description.unused_contact import unused_in_sdf, unused_in_urdf
from drake_twin.description.xml_reader import XmlReader

SHAPE = "<collision><geometry><box size='1 1 1'/></geometry></collision>"
MASS = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
STIFFNESS = "without effect: stiffness and damping of contact follow from the masses"
ISOTROPY = "without effect: friction is the same in all directions"
SMALLER = f"{ISOTROPY}, and the smaller coefficient counts"


def urdf(*gazebo, links=("left", "right")):
    bodies = "".join(f"<link name='{name}'>{MASS}{SHAPE}</link>" for name in links)
    return f"<robot name='r'>{bodies}<link name='bare'/>{''.join(gazebo)}</robot>"


def of_urdf(*gazebo, **options):
    return [item.what for item in unused_in_urdf(XmlReader(urdf(*gazebo, **options), None))]


def of(link, inside):
    return f"<gazebo reference='{link}'>{inside}</gazebo>"


def of_sdf(surface, **options):
    text = f"<model name='m'><link name='l'><collision name='c'><surface>{surface}</surface></collision></link></model>"
    reader = XmlReader(text)
    return [item.what for item in unused_in_sdf(reader, reader.root, with_links=True, **options)]


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        ("<mu1>0.5</mu1><mu2>0.5</mu2>", []),
        ("<mu1 value='0.5'/><mu2 value='0.50'/><maxContacts>3</maxContacts><material>Gazebo/Red</material>", []),
        ("<mu1>100</mu1><mu2>50</mu2>", []),  # the other surface's is the smaller one
        ("<mu1>0.5</mu1><mu2>0.1</mu2>", [f"mu1 of left: {SMALLER}"]),
        ("<kp>1e6</kp><kd>100</kd><minDepth>0.001</minDepth>", [f"kp, kd, min_depth of left: {STIFFNESS}"]),
        ("<kp>1e12</kp><kd>1.0</kd><fdir1>0 0 0</fdir1><slip1>0</slip1>", []),
        ("<fdir1>1 0 0</fdir1>", []),  # of two equal coefficients the direction changes nothing
        ("<mu1>0.8</mu1><mu2>0.8</mu2><fdir1>1 0 0</fdir1>", []),
        ("<mu1>0.8</mu1><fdir1>1 0 0</fdir1>", [f"fdir1 of left: {ISOTROPY}"]),
        (
            "<fdir1>1 0 0</fdir1><slip1>0.1</slip1>",
            [f"fdir1 of left: {ISOTROPY}", "slip1 of left: without effect: nothing slips below its limit of friction"],
        ),
        ("<slip1>0.1</slip1>", ["slip1 of left: without effect: nothing slips below its limit of friction"]),
        ("<sensor name='s' type='imu'><plugin><kp>3</kp></plugin></sensor>", []),
        ("<kp>hard</kp>", [f"kp of left: {STIFFNESS}"]),
    ],
)
def test_what_a_urdf_asks_of_contact(inside, expected):
    assert of_urdf(of("left", inside)) == expected


def test_links_share_a_sentence():
    assert of_urdf(of("left", "<kp>1</kp>"), of("right", "<kd>5</kd>")) == [f"kp, kd of left, right: {STIFFNESS}"]
    many = [f"l{index}" for index in range(9)]
    (text,) = of_urdf(*(of(link, "<kp>1</kp>") for link in many), links=many)
    assert text == f"kp of l0, l1, l2, l3, l4, l5 and 3 more: {STIFFNESS}"


def test_blanks_around_a_links_name_do_not_count():
    reader = XmlReader("<robot name='r'><link name=' left '><collision name='tyre'/></link></robot>")
    assert unused_in_urdf(reader) == []


def test_a_link_without_a_shape_has_no_surface():
    assert of_urdf(of("bare", "<mu1>0.2</mu1><mu2>1.0</mu2><kp>1</kp><material>Gazebo/Red</material>")) == [
        "mu1, kp of bare: without effect: the link has no collision shape"
    ]


def test_a_named_shape_does_not_have_the_surface_of_its_link():
    """As libsdformat gives ``<mu1>`` only to shapes without a name."""
    named = "<link name='named'><collision name='tyre'/><collision name='named_rim'/></link><gazebo reference='named'>"
    reader = XmlReader(f"<robot name='r'>{named}<mu1>0.2</mu1><mu2>0.2</mu2><kp>1e12</kp></gazebo></robot>")
    why = "without effect on collision shapes that have a name: Gazebo's reader gives those the default surface"
    assert [item.what for item in unused_in_urdf(reader)] == [f"mu1, mu2 of named: {why}"]


def test_a_folded_link_can_lose_its_surface_to_the_link_that_its_name_begins_with():
    """As libsdformat takes ``left_rib_collision_1`` for a shape that ``left`` always had."""
    joint = "<joint name='j' type='fixed'><parent link='left'/><child link='left_rib'/></joint>"
    rib = f"{joint}{of('left_rib', '<mu1>0.2</mu1>')}"
    (text,) = of_urdf(rib, links=("left", "left_rib"))
    why = "Gazebo's reader takes the link's shapes for those of the link that it is fixed to"
    assert text == f"mu1 of left_rib: without effect: {why}"


def test_coefficients_in_two_tags_are_those_of_one_link():
    assert of_urdf(of("left", "<mu1>0.5</mu1>"), of("left", "<mu2>0.7</mu2>")) == [f"mu2 of left: {SMALLER}"]


@pytest.mark.parametrize(
    ("surface", "expected"),
    [
        ("<friction><ode><mu>0.4</mu><mu2>0.4</mu2></ode></friction>", []),
        ("<friction><ode><mu>0.4</mu><mu2>0.6</mu2></ode></friction>", [f"mu2 of l: {SMALLER}"]),
        (
            "<friction><ode><mu>0.4</mu></ode><bullet><friction>0.9</friction><rolling_friction>1</rolling_friction></bullet></friction>",
            ["rolling_friction of l: without effect: rolling has no resistance but friction"],
        ),
        ("<friction><torsional><coefficient>1</coefficient></torsional></friction>", []),
        (
            "<friction><torsional><coefficient>1</coefficient><patch_radius>0.1</patch_radius></torsional></friction>",
            ["patch_radius of l: without effect: only contact between faces resists a turn on the spot"],
        ),
        (
            "<bounce><restitution_coefficient>0.8</restitution_coefficient><threshold>1</threshold></bounce>",
            ["restitution_coefficient of l: without effect: nothing bounces"],
        ),
        ("<bounce><restitution_coefficient>0</restitution_coefficient></bounce>", []),
        ("<contact><ode><kp>1e5</kp><max_vel>0.1</max_vel></ode></contact>", [f"kp, max_vel of l: {STIFFNESS}"]),
        ("<contact><collide_bitmask>0xffff</collide_bitmask></contact>", []),
        ("<contact><collide_bitmask>0x01</collide_bitmask></contact>", []),  # it meets 0xffff and its like
        (
            "<contact><collide_bitmask>0x02</collide_bitmask></contact>",
            ["collide_bitmask of l: without effect: shapes of different models always collide"],
        ),
    ],
)
def test_what_an_sdf_asks_of_contact(surface, expected):
    assert of_sdf(surface) == expected


def test_a_twin_warns_of_it(tmp_path):
    robot = tmp_path / "r.urdf"
    robot.write_text(urdf(of("left", "<kp>1e6</kp><mu1>0.5</mu1>"), links=("left",)).replace("<link name='bare'/>", ""))
    twin = TwinBuilder().robot("r", robot, xyz=(0, 0, 2)).build()
    assert twin.findings.warnings == (f"r: kp of left: {STIFFNESS} (r.urdf:1)",)
