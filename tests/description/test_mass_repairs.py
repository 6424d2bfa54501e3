import numpy as np
import pytest
import scipy.optimize
from lxml import etree
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from urdf_to_repair import INERTIA, INERTIAL, SOLID, joint, link, mend

from drake_twin.description.possible_inertia import possible_inertia


def tensor(root: etree._Element) -> np.ndarray:
    inertia = root.find("link/inertial/inertia")
    ixx, ixy, ixz, iyy, iyz, izz = (float(inertia.get(name)) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


@pytest.mark.parametrize("inertia", ["", "<inertia/>", INERTIA.format(0, 0, 0, 0, 0, 0)])
def test_a_mass_without_inertia_gets_that_of_a_small_sphere(inertia):
    root, (repair,) = mend(link(inside=INERTIAL.format(mass=2, inertia=inertia)))
    assert tensor(root) == pytest.approx(0.4 * 2 * 0.01**2 * np.eye(3))
    assert "has mass but no inertia: that of a sphere of 0.01 m is used [inertia]" in repair


@pytest.mark.parametrize(
    "values",
    [
        (9, 0, 0, 1, 0, 1),  # one moment larger than the others together
        (-1, 0, 0, 1, 0, 1),
        (1, 5, 0, 1, 0, 1),  # not positive definite
        (1e-9, 0, 0, 1, 0, 1),
        (1, 0, 0, 0, 0, 0),
        (-1, 0, 0, -1, 0, -1),
    ],
)
def test_an_inertia_that_no_body_can_have_becomes_one_that_drake_takes(values):
    root, (repair,) = mend(link(inside=INERTIAL.format(mass=2, inertia=INERTIA.format(*values))))
    moments = np.linalg.eigvalsh(tensor(root))
    assert moments[0] > 0
    assert moments[2] <= moments[0] + moments[1]
    assert "no body has the principal moments" in repair
    assert SpatialInertia(2.0, np.zeros(3), unit_inertia(tensor(root) / 2.0)).IsPhysicallyValid()


@pytest.mark.parametrize(
    "moments", [(1, 1, 9), (0.1, 0.2, 1), (-1, 1, 1), (-5, 1, 1), (0, 1, 1), (-3, -2, 4), (2, 3, 9)]
)
def test_no_possible_inertia_is_nearer(moments):
    """Against SciPy's search among rods along the axes, whatever the axes are."""
    axes = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    given = axes @ np.diag(moments).astype(float) @ axes.T
    found, why = possible_inertia(2.0, given)
    rods = 1.0 - np.eye(3)
    _, distance = scipy.optimize.nnls(rods, np.array(moments, dtype=float))
    assert np.linalg.norm(found - given) == pytest.approx(distance, abs=3e-6 * np.abs(moments).max())
    assert np.allclose(axes.T @ found @ axes, np.diag(np.diag(axes.T @ found @ axes)), atol=1e-12)
    assert "kg·m²: the nearest possible are used: " in why


@pytest.mark.parametrize("moments", [(1, 1, 2), (1e-3, 1, 1), (1, 1, 1), (2e-6, 1, 1)])
def test_what_a_body_can_have_is_left_as_it_is(moments):
    found, why = possible_inertia(2.0, np.diag(moments).astype(float))
    assert (np.diag(found).tolist(), why) == (list(moments), None)


def unit_inertia(moments: np.ndarray) -> UnitInertia:
    return UnitInertia(*np.diag(moments), moments[0, 1], moments[0, 2], moments[1, 2])


@pytest.mark.parametrize("mass", ["", '<mass value="0"/>'])
def test_an_inertia_without_mass_is_left_out(mass):
    arm_link = link("arm", f"<inertial>{mass}{INERTIA.format(1, 0, 0, 1, 0, 1)}</inertial>")
    root, (repair,) = mend(f"{link()}\n{arm_link}\n{joint(kind='fixed')}")
    assert len(root.findall("link/inertial")) == 1
    assert repair == 'arm.xacro:3: <link name="arm"> has inertia but no mass: its inertia is removed [inertia]'


def test_an_inertia_is_changed_no_further_than_needed():
    root, _ = mend(link(inside=INERTIAL.format(mass=2, inertia=INERTIA.format(1, 0, 0, 1, 0, 2.01))))
    assert tensor(root) == pytest.approx(np.diag([1.0, 1.0, 2.01]), rel=0.01)


def test_an_inertia_that_is_no_number_is_left_for_the_reader_to_refuse():
    body = link(inside=SOLID.replace('ixx="1"', 'ixx="heavy"'))
    root, repairs = mend(body)
    assert repairs == []
    assert root.find("link/inertial/inertia").get("ixx") == "heavy"


def test_a_floating_root_without_mass_gets_a_little():
    root, (repair,) = mend('<link name="base"/>')
    assert float(root.find("link/inertial/mass").get("value")) == 0.001
    assert repair == ('arm.xacro:2: <link name="base"> moves, but has no mass: it weighs 0.001 kg [massless_link]')


@pytest.mark.parametrize("inside", ["", INERTIAL.format(mass=0, inertia="")])
def test_a_moving_link_without_mass_gets_a_little(inside):
    body = f"{link()}\n{link('arm', inside)}\n{joint()}"
    root, (repair,) = mend(body)
    assert [float(mass.get("value")) for mass in root.iterfind("link/inertial/mass")] == [1.0, 0.001]
    assert repair.startswith('arm.xacro:3: <link name="arm"> moves')


def test_a_massless_link_that_carries_a_mass_is_left_alone():
    body = "\n".join(['<link name="base"/>', link("arm"), joint(kind="fixed")])
    assert mend(body)[1] == []


def test_a_link_that_is_welded_to_the_world_needs_no_mass():
    body = "\n".join(['<link name="world"/>', '<link name="base"/>', joint(kind="fixed", parent="world", child="base")])
    assert mend(body)[1] == []


def test_a_joint_without_child_is_left_for_the_reader_to_refuse():
    body = link() + '<link name="arm"/><joint name="elbow" type="continuous"><parent link="base"/></joint>'
    assert mend(body)[1] == []


def test_each_moment_of_a_mended_inertia_stands_where_it_belongs():
    given = np.array([[9.0, 0.4, 0.3], [0.4, 1.0, -0.2], [0.3, -0.2, 2.0]])
    values = (given[0, 0], given[0, 1], given[0, 2], given[1, 1], given[1, 2], given[2, 2])
    root, (repair,) = mend(link(inside=INERTIAL.format(mass=2, inertia=INERTIA.format(*values))))
    possible, _ = possible_inertia(2.0, given)
    written = [
        float(root.find("link/inertial/inertia").get(name)) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    ]
    assert written == [possible[0, 0], possible[0, 1], possible[0, 2], possible[1, 1], possible[1, 2], possible[2, 2]]
    assert len({round(abs(value), 6) for value in written}) == 6
    assert "[inertia]" in repair


def test_moments_that_are_not_given_are_zero():
    root, (repair,) = mend(link(inside='<inertial><mass value="2"/><inertia ixx="1" iyy="1"/></inertial>'))
    moments = np.linalg.eigvalsh(tensor(root))
    assert moments == pytest.approx([1.0, 1.0, 0.0] if moments[0] > moments[-1] else [0.0, 1.0, 1.0], abs=1e-5)
    assert "no body has the principal moments" in repair


@pytest.mark.parametrize("inertia", ["", INERTIA.format(0, 0, 0, 0, 0, 0)])
def test_an_empty_inertial_is_left_out_without_a_word(inertia):
    arm_link = link("arm", INERTIAL.format(mass=0, inertia=inertia))
    root, repairs = mend(f"{link()}\n{arm_link}\n{joint(kind='fixed')}")
    assert repairs == []
    assert len(root.findall("link/inertial")) == 1


@pytest.mark.parametrize("mass", ["-1", "heavy", "nan"])
def test_a_mass_that_is_none_is_left_for_the_reader_to_refuse(mass):
    body = link(inside=INERTIAL.format(mass=mass, inertia=INERTIA.format(9, 0, 0, 1, 0, 1)))
    root, _ = mend(body)
    assert root.find("link/inertial/inertia").get("ixx") == "9"


def test_who_gets_a_mass_is_who_moves_without_one():
    """A root whose mass hangs on a joint gets one; a link between two joints leaves it to what it carries."""
    links = "\n".join([link("base", ""), link("upper", ""), link("hand"), link("tool", ""), link("tip", "")])
    joints = joint("shoulder", "continuous", "base", "upper") + joint("elbow", "continuous", "upper", "hand")
    joints += joint("wrist", "continuous", "hand", "tool") + joint("end", "fixed", "tool", "tip")
    root, repairs = mend(f"{links}\n{joints}")
    heavy = {item.get("name") for item in root.iterfind("link") if item.find("inertial") is not None}
    assert heavy == {"base", "hand", "tool"}
    assert [text.partition(" moves")[0].rpartition('="')[2].rstrip('">') for text in repairs] == ["base", "tool"]


def test_a_root_is_heavy_by_what_is_fixed_to_it_and_not_by_what_moves():
    plate = f"{link('base', '')}\n{link('plate', '')}\n{link('block')}\n{link('arm')}\n"
    fixed = joint("one", "fixed", "base", "plate") + joint("two", "fixed", "plate", "block")
    assert mend(plate + fixed + joint("three", "continuous", "base", "arm"))[1] == []
    moving = joint("one", "fixed", "base", "plate") + joint("two", "continuous", "plate", "block")
    (repair,) = mend(plate + moving + joint("three", "continuous", "base", "arm"))[1]
    assert '"base"' in repair


def test_the_small_mass_replaces_every_inertial_of_the_link():
    inside = "<inertial/>" + INERTIAL.format(mass=0, inertia="")
    root, (repair,) = mend(f"{link()}\n{link('arm', inside)}\n{joint()}")
    (inertial,) = root.findall("link[@name='arm']/inertial")
    assert float(inertial.find("mass").get("value")) == 0.001
    assert float(inertial.find("inertia").get("ixx")) == pytest.approx(0.4 * 0.001 * 0.01**2)
    assert "[massless_link]" in repair
