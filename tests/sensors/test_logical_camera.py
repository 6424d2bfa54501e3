"""Logical cameras against planes that were worked out by hand (gz-math's src/Frustum.cc, gz-sensors' Contains)."""

from math import atan, pi, sqrt

import pytest
from conftest import ROVER
from rig import on_box, twin_with, xyz

from drake_twin.errors import InputError
from drake_twin.scenario import Robot

# Half an angle whose tangent is 1/2: what is seen is as wide as its distance, and half as high.
FRUSTUM = f"<near>1</near><far>10</far><horizontal_fov>{2 * atan(0.5)}</horizontal_fov><aspect_ratio>2</aspect_ratio>"
TOPIC = "/box/s/logical_camera"


def eye(inside=FRUSTUM, pose="0 0 1 0 0 0"):
    return on_box("logical_camera", f"<pose>{pose}</pose><logical_camera>{inside}</logical_camera>")


def thing(name, x, y, z, turn="0 0 0", inside=""):
    link = '<link name="l"><visual name="v"><geometry><sphere><radius>.1</radius></sphere></geometry></visual></link>'
    return f'<model name="{name}"><static>true</static><pose>{x} {y} {z} {turn}</pose>{link}{inside}</model>'


def seen(twin):
    return {item.name: item.pose for item in twin.latest(TOPIC).model}


@pytest.mark.parametrize("distance", [1.0, 4.0, 10.0])
@pytest.mark.parametrize(("by", "is_seen"), [(-1e-6, True), (1e-6, False)])
def test_what_is_within_the_six_planes_is_seen(tmp_path, distance, by, is_seen):
    """Origins a micrometer inside and outside of each plane; the camera is at (0, 0, 1.1)."""
    inner = min(max(distance, 1.0 + 1e-6), 10.0 - 1e-6)
    things = {
        "left": (inner, inner / 2 + by, 1.1),
        "right": (inner, -inner / 2 - by, 1.1),
        "top": (inner, 0.0, 1.1 + inner / 4 + by),
        "bottom": (inner, 0.0, 1.1 - inner / 4 - by),
        "near": (1.0 - by, 0.0, 1.1),
        "far": (10.0 + by, 0.0, 1.1),
    }
    twin = twin_with(tmp_path, eye(), world="".join(thing(name, *place) for name, place in things.items()))
    assert [*seen(twin)] == (sorted(things) if is_seen else [])


def test_poses_are_in_the_cameras_axes_and_its_own_in_the_world(tmp_path):
    world = thing("ahead", 1, 4, 1.1, f"0 0 {pi / 2}")
    twin = twin_with(tmp_path, eye(pose=f"0 0 1 0 0 {pi / 2}"), world=world, xyz=(1, 0, 0.1))
    message = twin.latest(TOPIC)
    assert message.header.frame_id == "box/box/s"
    assert xyz(message.pose.position) == pytest.approx([1, 0, 1.1], abs=1e-9)
    assert (message.pose.orientation.w, message.pose.orientation.z) == pytest.approx((sqrt(0.5), sqrt(0.5)))
    (ahead,) = message.model
    assert xyz(ahead.pose.position) == pytest.approx([4, 0, 0], abs=1e-9)
    assert ahead.pose.orientation.w == pytest.approx(1.0)


def test_robots_moving_models_and_models_inside_models_are_seen(tmp_path):
    body = '<link name="l"><inertial><mass>1</mass></inertial></link>'
    falling = f'<model name="stone"><pose>5 1 2 0 0 0</pose>{body}</model>'
    inner = f'<model name="knob"><pose>0 0 0.5 0 0 0</pose>{body}</model>'
    twin = twin_with(tmp_path, eye(), world=falling + thing("door", 6, -1, 1, inside=inner), time_step=0.001)
    twin.entities.spawn(Robot("rover", ROVER, xyz=(7, 0, 0.13)))
    assert [*seen(twin)] == ["door", "knob", "rover", "stone"]
    assert xyz(seen(twin)["knob"].position) == pytest.approx([6, -1, 0.4], abs=1e-9)
    assert xyz(seen(twin)["rover"].position) == pytest.approx([7, 0, -0.97], abs=1e-9)
    twin.advance_to(0.5)
    assert seen(twin)["stone"].position.z == pytest.approx(0.9 - 9.81 / 8, abs=0.01)
    twin.entities.delete("rover")
    assert "rover" not in seen(twin)


@pytest.mark.parametrize(
    ("inside", "what"),
    [
        ("<near>2</near><far>1</far>", "far is 1, but it must be above near, 2"),
        ("<near>-1</near>", "near is '-1', but it must be at least 0"),
        ("<horizontal_fov>4</horizontal_fov>", "horizontal_fov is '4', but it must be"),
        ("<aspect_ratio>0</aspect_ratio>", "aspect_ratio is '0', but it must be"),
    ],
)
def test_a_frustum_that_cannot_be_is_refused_with_its_line(tmp_path, inside, what):
    with pytest.raises(InputError, match=what) as raised:
        twin_with(tmp_path, eye(inside))
    assert raised.value.line
