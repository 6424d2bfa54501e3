"""Light links on fixed joints give their inertia to the heaviest link that they are fixed to."""

import numpy as np
import pytest
from lxml import etree

from drake_twin.diagram.lumped_masses import gave_its_mass, with_lumped_masses

LEG = '<inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/>'


def robot(foot_mass, foot_inertia="", shape="<collision/>"):
    """A leg of 2 kg, and a foot 0.4 m below it on a fixed joint."""
    return (
        f'<robot name="r"><link name="leg"><inertial><mass value="2"/>{LEG}</inertial></link><link name="foot">'
        f'<inertial><mass value="{foot_mass}"/>{foot_inertia}</inertial>{shape}</link><joint name="ankle" type="fixed">'
        '<origin xyz="0 0 -0.4"/><parent link="leg"/><child link="foot"/></joint></robot>'
    )


def test_a_point_of_mass_adds_the_reduced_mass_times_the_square_of_the_distance():
    """2 and 0.5 kg: 0.4 kg · (0.4 m)² across the line between them, and nothing about it."""
    text = robot(0.5)
    leg = etree.fromstring(with_lumped_masses(text).encode()).find("link[@name='leg']/inertial")
    assert float(leg.find("mass").get("value")) == 2.5
    assert np.array(leg.find("origin").get("xyz").split(), dtype=float) == pytest.approx([0.0, 0.0, -0.08])
    moments = {name: float(value) for name, value in leg.find("inertia").items()}
    assert moments == pytest.approx({"ixx": 0.164, "iyy": 0.264, "izz": 0.3, "ixy": 0.0, "ixz": 0.0, "iyz": 0.0})
    assert (gave_its_mass(text, "foot"), gave_its_mass(text, "leg")) == (True, False)


@pytest.mark.parametrize("text", [robot(0.0), robot(2.0), robot(0.5, shape="")])
def test_links_without_a_mass_heavy_links_and_those_that_touch_nothing_stay(text):
    assert with_lumped_masses(text) == text
    assert not gave_its_mass(text, "foot")


def test_the_foots_own_inertia_is_added_in_the_axes_of_the_leg():
    text = robot(0.5, LEG).replace('<origin xyz="0 0 -0.4"/>', f'<origin xyz="0 0 0" rpy="0 0 {np.pi / 2}"/>')
    moments = etree.fromstring(with_lumped_masses(text).encode()).find("link[@name='leg']/inertial/inertia")
    assert [float(moments.get(name)) for name in ("ixx", "iyy", "izz")] == pytest.approx([0.3, 0.3, 0.6])
