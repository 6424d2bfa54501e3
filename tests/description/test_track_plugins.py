"""gz-sim's TrackController and TrackedVehicle as one controller: by the systems' sources."""

from math import inf

import pytest
from belts import TRACK, plugin, track, tracked_vehicle
from pydrake.math import RollPitchYaw
from sdf_worlds import world_of

from drake_twin.controllers.tracks import Tracks
from drake_twin.description.gazebo_drives import gazebo_drives
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.parameters import read_parameters
from drake_twin.description.robot_model import load_robot_model
from drake_twin.description.roller_wheels import roller_wheels
from drake_twin.description.surface_velocity import has_surface_velocity
from drake_twin.errors import InputError

VEHICLE = "tracked_vehicle (gz-sim-tracked-vehicle-system)"
LINKS = ("body", "left", "right", "arm.left")


@pytest.fixture(autouse=True)
def newest_drake(monkeypatch):
    """What becomes of the plugins where Drake has moving surfaces."""
    monkeypatch.setattr("drake_twin.description.plugins.tracks.has_surface_velocity", lambda: True)


def description(folder, plugins):
    links = "".join(f'<link name="{link}"/>' for link in LINKS)
    joints = "".join(
        f'<joint name="j{number}" type="fixed"><parent>body</parent><child>{link}</child></joint>'
        for number, link in enumerate(LINKS[1:])
    )
    file = folder / "tank.sdf"
    file.write_text(f'<sdf version="1.9"><model name="tank">{links}{joints}\n{plugins}</model></sdf>')
    return load_robot_model(str(file), PackageIndex(())).description


def drives(folder, plugins):
    return gazebo_drives(description(folder, plugins))


def parameters(drive):
    values, findings = read_parameters(Tracks.Parameters, drive.controller)
    assert findings == ()
    return values


def not_started(folder, plugins):
    return [drive.not_started for drive in drives(folder, plugins) if drive.not_started]


def test_a_track_with_nothing_said(tmp_path):
    (drive,) = drives(tmp_path, track("left"))
    assert drive.topics == {
        "left/track_cmd_vel": "link/left/track_cmd_vel",
        "left/odometry": "link/left/odometry",
    }
    assert drive.gz_topics == {
        "left/track_cmd_vel": "/model/{model}/link/left/track_cmd_vel",
        "left/odometry": "/model/{model}/link/left/odometry",
    }
    (own,) = parameters(drive).tracks.values()
    assert (own.link, own.axis, own.max_command_age, own.odometry_publish_frequency) == ("left", (0, 1, 0), inf, 50.0)
    assert not parameters(drive).is_vehicle
    assert "update_rate" not in drive.controller.parameters


def test_a_track_with_everything_said(tmp_path):
    more = (
        "<velocity_topic>/belt/speed</velocity_topic><odometry_topic>way</odometry_topic><debug>0</debug>"
        "<odometry_publish_frequency>200</odometry_publish_frequency><max_command_age>2</max_command_age>"
        "<track_orientation>0 0 1.5707963267948966</track_orientation><min_velocity>-1</min_velocity>"
        "<max_velocity>2</max_velocity><min_acceleration>-3</min_acceleration><max_acceleration>4</max_acceleration>"
        "<min_jerk>-5</min_jerk><max_jerk>6</max_jerk>"
    )
    (drive,) = drives(tmp_path, track("left", more))
    assert drive.topics == {"left/track_cmd_vel": "belt/speed", "left/odometry": "way"}
    assert drive.gz_topics == {"left/track_cmd_vel": "/belt/speed", "left/odometry": "way"}
    (own,) = parameters(drive).tracks.values()
    assert own.axis == pytest.approx((-1, 0, 0))
    assert (own.max_command_age, own.odometry_publish_frequency) == (2.0, 200.0)
    limits = own.limits
    assert (limits.min_velocity, limits.max_velocity) == (-1, 2)
    assert (limits.max_acceleration_reverse, limits.max_acceleration) == (-3, 4)
    assert (limits.min_jerk, limits.max_jerk) == (-5, 6)
    assert drive.controller.parameters["update_rate"] == 200.0
    assert drive.unread == ()


@pytest.mark.parametrize("angles", [(0.5, 0, 0), (0, 0.5, 0), (0.3, -0.2, 1)])
def test_the_axis_is_the_turned_y(tmp_path, angles):
    turned = " ".join(map(str, angles))
    (drive,) = drives(tmp_path, track("left", f"<track_orientation>{turned}</track_orientation>"))
    (own,) = parameters(drive).tracks.values()
    assert own.axis == pytest.approx(RollPitchYaw(*angles).ToRotationMatrix().matrix()[:, 1])


def test_the_first_track_stands_for_all_and_the_vehicle(tmp_path):
    more = (
        "<steering_efficiency>0.7</steering_efficiency><tracks_height>0.2</tracks_height><body_link>body</body_link>"
        "<linear_velocity><max_velocity>2</max_velocity></linear_velocity>"
        "<angular_velocity><min_velocity>-1</min_velocity><max_acceleration>3</max_acceleration></angular_velocity>"
    )
    vehicle, first, second, third = drives(
        tmp_path, tracked_vehicle(more) + track("left") + track("right") + track("arm.left")
    )
    assert [item.is_part for item in (vehicle, first, second, third)] == [True, False, True, True]
    assert (vehicle.unread, first.unread) == ((), ())
    own = parameters(first)
    assert {name: item.link for name, item in own.tracks.items()} == {
        "left": "left",
        "right": "right",
        "arm_left": "arm.left",
    }
    assert (own.left_tracks, own.right_tracks, list(own.sides())) == (("left",), ("right",), [0, 1, None])
    assert (own.tracks_separation, own.steering_efficiency) == (0.4, 0.7)
    assert (own.linear.x.max_velocity, own.linear.x.min_velocity) == (2, -inf)
    assert (own.angular.z.min_velocity, own.angular.z.max_acceleration) == (-1, 3)
    assert (own.odom_frame_id, own.base_frame_id, own.use_stamped_vel) == ("odom", "body", False)
    assert first.topics["cmd_vel_unstamped"] == "cmd_vel"
    assert first.gz_topics["odom"] == "/model/{model}/odometry"
    assert first.gz_topics["steering_efficiency"] == "/model/{model}/steering_efficiency"
    assert first.odometry_rate == 50.0


def test_a_vehicle_moves_the_tracks_that_hear_its_topics(tmp_path):
    sides = (
        "<left_track><link>x</link><velocity_topic>/one</velocity_topic></left_track>"
        "<left_track><link>arm.left</link></left_track>"
        "<right_track><velocity_topic>two</velocity_topic><link>y</link></right_track>"
    )
    *_, vehicle = found = drives(
        tmp_path,
        track("left", "<velocity_topic>/one</velocity_topic>")
        + track("right", "<velocity_topic>/two</velocity_topic>")
        + track("arm.left")
        + tracked_vehicle(sides=sides),
    )
    own = parameters(found[0])
    assert (own.left_tracks, own.right_tracks) == (("left", "arm_left"), ("right",))
    assert vehicle.is_part


def test_what_the_twin_does_not_use_is_said(tmp_path):
    (drive,) = drives(
        tmp_path, track("left", "<center_of_rotation_topic>/c</center_of_rotation_topic><debug>1</debug>")
    )
    assert drive.unread == ("center_of_rotation_topic", "debug")


@pytest.mark.parametrize(
    ("plugins", "why"),
    [
        (
            plugin("track-controller", "TrackController", ""),
            "track_controller (gz-sim-track-controller-system): <link> is missing",
        ),
        (track("toe"), f"track_controller ({TRACK}): the robot has no link 'toe'"),
        (track("left") + track("left"), f"track_controller_2 ({TRACK}): another one has the link 'left'"),
        (
            track("left") + tracked_vehicle(sides="<left_track><link>left</link></left_track>"),
            f"{VEHICLE}: <right_track> is missing",
        ),
        (
            track("left") + tracked_vehicle(),
            f"{VEHICLE}: no track of {TRACK} hears what it sends to <right_track>",
        ),
        (
            track("left") + track("right") + tracked_vehicle() * 2,
            "tracked_vehicle_2 (gz-sim-tracked-vehicle-system): another one drives the robot",
        ),
    ],
)
def test_what_cannot_work_is_said_and_the_others_do(tmp_path, plugins, why):
    assert not_started(tmp_path, plugins) == [why]


def test_a_track_that_cannot_work_leaves_the_work_to_the_next(tmp_path):
    bad, good = drives(tmp_path, track("toe") + track("left"))
    assert bad.not_started
    assert list(parameters(good).tracks) == ["left"]


@pytest.mark.parametrize(
    ("plugins", "what"),
    [
        (track("left", "<max_command_age>-1</max_command_age>"), "<max_command_age> is -1, and has to be zero or more"),
        (track("left", "<max_velocity>fast</max_velocity>"), "<max_velocity> is 'fast', which is"),
        (track("left", "<track_orientation>1 2</track_orientation>"), "is '1 2', which is not three finite numbers"),
        (
            track("left") + track("right") + tracked_vehicle("<steering_efficiency>0</steering_efficiency>"),
            "<steering_efficiency> is 0, and has to be above zero",
        ),
        (
            track("left") + track("right") + tracked_vehicle("<odom_publish_frequency>x</odom_publish_frequency>"),
            "<odom_publish_frequency> is 'x', which is",
        ),
    ],
)
def test_values_that_are_refused(tmp_path, plugins, what):
    with pytest.raises(InputError, match=r"tank\.sdf:2: ") as raised:
        drives(tmp_path, plugins)
    assert what in str(raised.value)


def test_a_drake_without_moving_surfaces_is_said_once(tmp_path, monkeypatch):
    monkeypatch.setattr("drake_twin.description.plugins.tracks.has_surface_velocity", lambda: False)
    plugins = tracked_vehicle() + track("left") + track("right")
    (said,) = not_started(tmp_path, plugins)
    assert said.endswith("a moving surface needs Drake 1.56 or newer, which needs Python 3.12 or newer")


def test_the_probe_asks_drake():
    from pydrake.multibody.plant import MultibodyPlant

    assert has_surface_velocity() is hasattr(MultibodyPlant, "get_surface_speeds_input_port")


FLIPPER = """<link name="{0}"><collision name="c"><pose>0 0 0 1.5708 0 0</pose><geometry><cylinder><radius>0.1</radius>
<length>0.05</length></cylinder></geometry><surface><friction><ode><mu>0.7</mu><mu2>150</mu2><fdir1>0 1 0</fdir1></ode>
</friction></surface></collision></link><joint name="{0}_joint" type="revolute"><parent>body</parent><child>{0}</child>
<axis><xyz>0 1 0</xyz>{1}</axis></joint>"""


@pytest.mark.parametrize(
    ("limit", "plugins", "count"),
    [
        ("", "", 4),
        ("<limit><lower>-1e16</lower><upper>1e16</upper></limit>", "", 4),
        ("<limit><lower>0</lower><upper>1.5</upper></limit>", "", 0),
        ("", "".join(track(f"flipper{number}") for number in range(4)), 0),
    ],
)
def test_flippers_with_friction_in_one_direction_are_no_wheels_with_rollers(tmp_path, limit, plugins, count):
    links = "".join(FLIPPER.format(f"flipper{number}", limit) for number in range(4))
    file = tmp_path / "r.sdf"
    file.write_text(f'<sdf version="1.9"><model name="r"><link name="body"/>{links}{plugins}</model></sdf>')
    assert len(roller_wheels(load_robot_model(str(file), PackageIndex(())).description)) == count


@pytest.mark.parametrize(("static", "is_robot"), [("<static>1</static>", True), ("", True)])
def test_a_belt_of_a_world_is_a_robot(tmp_path, static, is_robot):
    link = '<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'
    world = world_of(tmp_path, f'<model name="m">{static}{link}{track("l")}</model>')
    assert (world.models[0].robot is not None) is is_robot


def test_another_drive_makes_no_robot_of_what_stands_still(tmp_path):
    drive = plugin("velocity-control", "VelocityControl", "")
    world = world_of(tmp_path, f'<model name="m"><static>1</static><link name="l"/>{drive}</model>')
    assert world.models[0].robot is None
