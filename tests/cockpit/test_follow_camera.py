import numpy as np
import pytest
from conftest import rovers

from drake_twin.cockpit.follow_camera import FollowCamera
from drake_twin.cockpit.scene import OVERLAYS, TWIN
from drake_twin.errors import InputError


class Scene:
    """Where Meshcat would be told to put things."""

    def __init__(self):
        self.places = {}
        self.cameras = []

    def set_transform(self, path, pose):
        self.places[path] = pose.translation()

    def set_camera_pose(self, camera, target):
        self.cameras.append((camera, target))


@pytest.fixture
def followed():
    scene = Scene()
    return scene, FollowCamera(scene), rovers(2).build()


def test_the_scene_moves_so_that_the_robot_stays_in_the_middle(followed):
    scene, camera, twin = followed
    camera.follow("robot_2", twin)
    assert scene.places[TWIN] == pytest.approx(-np.array(twin.robot_state("robot_2").base_pose[:3]))
    twin.publish("/robot_2/forward_velocity_controller/commands", [9] * 4)
    twin.advance_to(1.0)
    camera.draw(twin)
    position = np.array(twin.robot_state("robot_2").base_pose[:3])
    assert position[0] > 0.3
    assert all(place == pytest.approx(-position) for place in scene.places.values())
    assert scene.places.keys() == {TWIN, OVERLAYS}


def test_letting_go_puts_the_scene_back_and_keeps_looking_at_the_robot(followed):
    scene, camera, twin = followed
    camera.follow("robot_2", twin)
    camera.follow("", twin)
    assert all(place == pytest.approx(np.zeros(3)) for place in scene.places.values())
    assert scene.cameras[-1][1] == pytest.approx(twin.robot_state("robot_2").base_pose[:3])


def test_while_nobody_is_followed_nothing_is_sent(followed):
    scene, camera, twin = followed
    camera.draw(twin)
    camera.follow("", twin)
    assert (scene.places, scene.cameras) == ({}, [])


def test_a_robot_that_is_not_there_cannot_be_followed(followed):
    _, camera, twin = followed
    with pytest.raises(InputError, match="robot 'robot_9'"):
        camera.follow("robot_9", twin)
    assert camera.robot == ""
