"""A robot's feet: how they touch where the weight is beside the middle of what it stands on."""

import pytest

from drake_twin import TwinBuilder

PYRAMID = [(0, 0, 0), (0.02, 0.02, 0.05), (-0.02, 0.02, 0.05), (-0.02, -0.02, 0.05), (0.02, -0.02, 0.05)]
BLOCK = [(x, y, z) for z in (0.0, 0.05) for x in (-0.02, 0.02) for y in (-0.02, 0.02)]
EDGE = [(x, 0.0, 0.0) for x in (-0.02, 0.02)] + PYRAMID[1:]


def blunt(share):
    """A pyramid whose sole has a share of the area of its top."""
    side = 0.02 * share**0.5
    return [(side * x, side * y, 0.0) for x in (-1, 1) for y in (-1, 1)] + PYRAMID[1:]


def table(folder, foot, ahead):
    """A table of 5 kg with four feet at ±0.15 m and a flap, whose weight is ahead of the middle (m)."""
    import trimesh

    trimesh.convex.convex_hull(foot).export(folder / "foot.obj")
    feet = "".join(
        f"""<collision name="foot_{x}_{y}"><origin xyz="{x} {y} 0"/><geometry><mesh filename="{folder}/foot.obj"/>
        </geometry></collision>"""
        for x in (-0.15, 0.15)
        for y in (-0.15, 0.15)
    )
    (folder / "table.urdf").write_text(f"""<robot name="table"><link name="base"><inertial><origin xyz="{ahead} 0 0.1"/>
      <mass value="5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>{feet}</link>
    <link name="flap"><inertial><mass value="0.01"/>
      <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="hinge" type="continuous"><parent link="base"/><child link="flap"/><origin xyz="0 0 0.1"/></joint>
    </robot>""")
    return TwinBuilder().robot("table", folder / "table.urdf", xyz=(0, 0, 0.001)).build()


@pytest.mark.parametrize(
    ("foot", "ahead", "touches"),
    [
        (PYRAMID, 0.0, "faces"),
        (PYRAMID, 0.12, "point"),  # what stands on a tip has no face that would bear its share of the weight
        (EDGE, 0.12, "point"),
        (BLOCK, 0.12, "faces"),
        (blunt(0.045), 0.12, "point"),  # less than a twentieth is round
        (blunt(0.055), 0.12, "faces"),
    ],
)
def test_feet_that_stand_on_tips_touch_in_points_where_they_bear_unlike_shares(tmp_path, foot, ahead, touches):
    assert [item.touches for item in table(tmp_path, foot, ahead).built.shapes if item.model] == [touches] * 4


@pytest.mark.parametrize("foot", [PYRAMID, BLOCK])
def test_the_table_stands_level_on_feet_that_bear_unlike_shares(tmp_path, foot):
    twin = table(tmp_path, foot, 0.12)
    twin.advance_to(1.0)
    state = twin.entities.state("table")
    assert state.position[2] == pytest.approx(0.0, abs=3e-4)
    assert [abs(part) for part in state.orientation[1:]] == pytest.approx([0.0] * 3, abs=5e-4)
