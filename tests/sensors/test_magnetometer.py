"""Magnetometers against the world's field, turned by hand."""

from math import pi, radians

import pytest
from rig import on_box, twin_with, xyz


@pytest.mark.parametrize(("yaw", "expected"), [(0, (1, 2, 3)), (90, (2, -1, 3)), (180, (-1, -2, 3)), (270, (-2, 1, 3))])
def test_a_magnetometer_turned_four_ways_has_the_worlds_field_in_its_own_axes(tmp_path, yaw, expected):
    field = "<magnetic_field>1e-5 2e-5 3e-5</magnetic_field>"
    twin = twin_with(tmp_path, on_box("magnetometer"), world=field, rpy=(0, 0, radians(yaw)))
    message = twin.latest("/box/s/magnetometer")
    assert xyz(message.magnetic_field) == pytest.approx([1e-5 * value for value in expected], abs=1e-18)
    assert message.header.frame_id == "box/box/s"


def test_a_magnetometer_on_its_side_has_up_in_its_own_y(tmp_path):
    field = "<magnetic_field>1e-5 2e-5 3e-5</magnetic_field>"
    inside = f"<pose>0 0 0 {pi / 2} 0 0</pose>"
    twin = twin_with(tmp_path, on_box("magnetometer", inside), world=field)
    assert xyz(twin.latest("/box/s/magnetometer").magnetic_field) == pytest.approx([1e-5, 3e-5, -2e-5], abs=1e-18)


def test_without_a_field_of_its_own_a_world_has_that_of_sdf(tmp_path):
    # sdformat's sdf/1.x/world.sdf: <magnetic_field> defaults to this.
    twin = twin_with(tmp_path, on_box("magnetometer"), world=None)
    expected = [5.5645e-6, 22.8758e-6, -42.3884e-6]
    assert xyz(twin.latest("/box/s/magnetometer").magnetic_field) == pytest.approx(expected, rel=1e-12)
