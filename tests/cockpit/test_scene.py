"""What a page has to draw: the newest of everything, whoever comes when."""

import numpy as np
import umsgpack
from conftest import rovers
from pydrake.geometry import Box, Rgba
from pydrake.math import RigidTransform

from drake_twin.cockpit.scene import TWIN, Commands, Scene
from drake_twin.shared_viewer.meshcat_protocol import delete, set_property, set_transform

RED = Rgba(1, 0, 0)


def told(commands):
    return [(command["type"], command["path"]) for command in map(umsgpack.unpackb, commands.contents())]


def at(path, x):
    return set_transform(path, RigidTransform([x, 0, 0]).GetAsMatrix4())


def test_of_two_commands_for_one_thing_the_later_counts():
    commands = Commands()
    commands.add([at("/a", 1), at("/b", 1), at("/a", 2)], keep_deletions=True)
    assert told(commands) == [("set_transform", "/b"), ("set_transform", "/a")]
    assert umsgpack.unpackb(commands.contents()[1])["matrix"][12] == 2
    commands.add([set_property("/a", "visible", True), set_property("/a", "color", 1)], keep_deletions=True)
    assert len(commands) == 4


def test_what_is_deleted_takes_all_below_it_along_and_nothing_beside_it():
    commands = Commands()
    commands.add([at("/a/b", 1), at("/ab", 1), delete("/a"), at("/a/c", 1)], keep_deletions=True)
    assert told(commands) == [("set_transform", "/ab"), ("delete", "/a"), ("set_transform", "/a/c")]
    fresh = Commands()
    fresh.add([at("/a/b", 1), delete("/a"), at("/a/c", 1)], keep_deletions=False)
    assert told(fresh) == [("set_transform", "/a/c")]


def test_a_frame_is_one_array_of_messagepack():
    commands = Commands()
    commands.add([at("/a", 1), delete("/b")], keep_deletions=True)
    assert [item["type"] for item in umsgpack.unpackb(commands.packed())] == ["set_transform", "delete"]


def test_a_page_that_comes_late_draws_what_one_that_was_there_draws():
    scene, twin, watching = Scene(), rovers(2).build(), Commands()
    scene.listen(lambda commands: watching.add(commands, keep_deletions=False))
    scene.set_up(twin)
    scene.draw(twin)
    scene.set_object("/mark", Box(1, 1, 1), RED)
    twin.publish("/robot_1/forward_velocity_controller/commands", [9] * 4)
    twin.advance_to(0.5)
    scene.draw(twin)
    twin.entities.delete("robot_2")
    scene.draw(twin)
    scene.delete("/mark")
    late = scene.everything()
    assert sorted(late.contents()) == sorted(watching.contents())
    assert not scene.has_path("/mark")
    assert scene.has_path(f"{TWIN}/robot_1")
    assert not scene.has_path(f"{TWIN}/robot_2")


def test_points_lines_and_shapes_are_at_their_paths_until_they_are_deleted():
    scene, sent = Scene(), Commands()
    scene.listen(lambda commands: sent.add(commands, keep_deletions=True))
    points = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    scene.set_points("/marks/points", points, (1.0, 0.0, 0.0), 0.01)
    scene.set_lines("/marks/lines", points, (1.0, 0.0, 0.0))
    scene.set_object("/marks/box", Box(1, 1, 1), RED)
    assert told(sent) == [("set_object", f"/marks/{name}") for name in ("points", "lines", "box")]
    for content, kind in zip(sent.contents()[:2], ("Points", "LineSegments"), strict=True):
        drawn = umsgpack.unpackb(content)["object"]
        assert kind in [item["type"] for item in (drawn["object"], *drawn["object"].get("children", ()))]
        data = drawn["geometries"][0]["data"]["attributes"]["position"]["array"].data
        assert np.frombuffer(data, dtype=np.float32).tolist() == [1, 2, 3, 4, 5, 6]
    assert scene.has_path("/marks/points")
    scene.delete("/marks")
    assert not scene.has_path("/marks")


def test_a_slow_page_is_owed_no_more_than_the_scene_has_parts():
    scene, twin, owed = Scene(), rovers(1).build(), Commands()
    scene.draw(twin)
    scene.listen(lambda commands: owed.add(commands, keep_deletions=True))
    twin.publish("/robot_1/forward_velocity_controller/commands", [9] * 4)
    for _ in range(50):
        twin.step(10)
        scene.draw(twin)
    assert 0 < len(owed) <= len(scene.everything())


def test_what_does_not_move_is_not_sent_again():
    scene, twin, sent = Scene(), rovers(1).build(), []
    twin.pause()
    scene.draw(twin)
    scene.listen(sent.extend)
    scene.draw(twin)
    assert sent == []


def test_a_matrix_may_stretch():
    scene = Scene()
    scene.set_transform("/a", np.diag([1.0, 1.0, 3.0, 1.0]))
    (content,) = scene.everything().contents()
    assert umsgpack.unpackb(content)["matrix"][10] == 3.0
