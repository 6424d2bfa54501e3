"""Altimeters against free fall and turning links."""

import pytest
from rig import on_box, twin_with

G = 9.81


def test_an_altimeter_falls_as_a_stone(tmp_path):
    twin = twin_with(tmp_path, on_box("altimeter", "<pose>0.1 0 0.3 0 0 0</pose>"), xyz=(0, 0, 50), time_step=1e-4)
    twin.advance_to(1.0)
    message = twin.latest("/box/s/altimeter")
    assert message.vertical_reference == pytest.approx(50.3)
    assert message.vertical_position == pytest.approx(-G / 2, rel=2e-4)
    assert message.vertical_velocity == pytest.approx(-G, rel=1e-9)


def test_an_altimeter_beside_the_axis_of_a_turning_link_moves_up_and_down(tmp_path):
    twin = twin_with(tmp_path, on_box("altimeter", "<pose>0.5 0 0 0 0 0</pose>"), xyz=(0, 0, 50))
    twin.entities.set_state("box", linear=(0, 0, 1.0), angular=(0, 2.0, 0))
    message = twin.latest("/box/s/altimeter")
    assert message.vertical_velocity == pytest.approx(1.0 - 2.0 * 0.5)


@pytest.mark.parametrize("noisy", ["vertical_position", "vertical_velocity"])
def test_height_and_velocity_have_each_its_own_noise(tmp_path, noisy):
    noise = "<noise type='gaussian'><mean>7</mean></noise>"
    inside = f"<altimeter><{noisy}>{noise}</{noisy}></altimeter>"
    twin = twin_with(tmp_path, on_box("altimeter", inside), xyz=(0, 0, 50))
    message = twin.latest("/box/s/altimeter")
    found = {name: getattr(message, name) for name in ("vertical_position", "vertical_velocity")}
    assert found == {**dict.fromkeys(found, 0.0), noisy: 7.0}
