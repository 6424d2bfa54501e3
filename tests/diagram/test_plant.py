"""Parts of a robot in the plant, against closed forms."""

from math import cos, sqrt

import pytest

from drake_twin import TwinBuilder, World

ARM = """<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="base">
  <geom name="foot" type="sphere" size="0.01" mass="1"/>
  <body name="disc"><joint name="j" type="{kind}" axis="0 0 1" {spring}/>
    <inertial pos="0 0 0" mass="0.1" diaginertia="0.1 0.1 0.1"/></body></body></worldbody></mujoco>"""


@pytest.mark.parametrize("kind", ["hinge", "slide"])
@pytest.mark.parametrize(("spring", "rest", "stiffness"), [('stiffness="4" springref="0.5"', 0.5, 4.0), ("", 0.0, 0.0)])
def test_a_joints_spring_swings_it_about_its_position_of_rest(tmp_path, kind, spring, rest, stiffness):
    """0.1 q'' = k (rest - q), from rest at 0; as MuJoCo documents stiffness and springref."""
    (tmp_path / "arm.xml").write_text(ARM.format(kind=kind, spring=spring))
    twin = TwinBuilder(world=World(gravity=(0.0, 0.0, 0.0))).robot("arm", tmp_path / "arm.xml").build()
    for time in (0.1, 0.25, 0.5):
        twin.advance_to(time)
        expected = rest * (1.0 - cos(sqrt(stiffness / 0.1) * time))
        assert twin.robot_state("arm").positions[0] == pytest.approx(expected, abs=5e-3)
