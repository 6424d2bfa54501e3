"""Bags on the page: robots where the bag says they were, time controls, and what is refused."""

import shutil

import numpy as np
import pytest
from conftest import ARM, ROVER
from playback.recorded_bags import CART, HALF, STATES, TEXT, TRANSFORMS, cart_messages, record, transforms, write
from playback.recorded_bags import joint_state as joints
from rosbags.rosbag2 import StoragePlugin

from drake_twin import InputError, Twin, TwinBuilder
from drake_twin.cockpit import protocol
from drake_twin.messages.interface_types import make
from drake_twin.play import main
from drake_twin.playback.bag import Bag
from drake_twin.playback.bag_player import BagPlayer
from drake_twin.playback.robots import recorded_scenario


@pytest.fixture
def played():
    """Opens a bag; returns its player and its twin."""
    bags = []

    def open_(folder):
        bags.append(Bag(folder))
        scenario, robots = recorded_scenario(bags[-1])
        twin = Twin(scenario)
        return BagPlayer(bags[-1], twin, robots), twin

    yield open_
    for bag in bags:
        bag.close()


def test_a_twins_bag_has_each_link_where_the_twin_had_it(tmp_path, played):
    """Two rovers and an arm, whose controllers move all of their joints; the twin's own links are compared."""
    builder = TwinBuilder()
    for index, name in enumerate(("robot_1", "robot_2")):
        builder.robot(name, ROVER, xyz=(0, 2.0 * index, 0.13)).static_transform("world", f"{name}_odom")
    twin = builder.robot("arm", ARM, xyz=(0, -2, 0)).build()
    twin.publish("/robot_1/forward_velocity_controller/commands", [1.0, 4.0, 1.0, 4.0])
    twin.publish("/robot_2/forward_velocity_controller/commands", [-3.0] * 4)
    links = [f"{plan.name}::{link}" for plan in twin.built.plans for link in plan.description.links if link != "world"]
    seen = {}

    def see(message):
        seen[round(twin.time, 6)] = {link: twin.entities.state(link) for link in links}

    record(twin, tmp_path / "bag", 1.0, see)
    player, shown = played(tmp_path / "bag")
    assert {plan.name for plan in shown.built.plans} == {"robot_1", "robot_2", "arm"}
    times = sorted(seen)
    assert len(times) >= 10
    for time in times[5::5]:
        player.advance_to(time + 1e-6)
        for link in links:
            state, expected = shown.entities.state(link), seen[time][link]
            np.testing.assert_allclose(state.position, expected.position, atol=1e-9, err_msg=f"{link} at {time}")
            assert abs(np.dot(state.orientation, expected.orientation)) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
@pytest.mark.parametrize("namespace", ["", "/site/cart_7"])
def test_another_programs_bag(tmp_path, played, plugin, namespace):
    """At 1 s the cart is 1 m along x of odom, which is y of map, and its mast is lifted by 0.25 m."""
    player, twin = played(write(tmp_path / "bag", cart_messages(namespace), plugin))
    (plan,) = twin.built.plans
    assert plan.name == (namespace.strip("/").replace("/", "_") or "cart")
    state = {"robots": {plan.name: {}}}
    player.amend(state)
    assert state["robots"][plan.name] == {"velocities": [0.0], "efforts": [0.0]}  # before the first message
    player.advance_to(1.0)
    base = twin.entities.state(plan.name)
    np.testing.assert_allclose(base.position, [1.0, 1.0, 0.5], atol=1e-12)
    np.testing.assert_allclose(base.orientation, [HALF, 0, 0, HALF], atol=1e-12)
    np.testing.assert_allclose(twin.entities.state(f"{plan.name}::mast").position, [1.0, 1.0, 0.75], atol=1e-12)
    state = {"robots": {plan.name: {}}}
    player.amend(state)
    assert state["time"] == 1.0
    assert state["robots"][plan.name] == {"velocities": [0.5], "efforts": [0.75]}
    assert (plan.controllers, plan.sensors) == ((), ())


def test_joint_states_that_lack_a_joint_leave_it_where_it_is(tmp_path, played):
    grip = '<link name="grip"/><joint name="close" type="continuous"><parent link="mast"/><child link="grip"/></joint>'
    messages = cart_messages(text=CART.replace("</robot>", f"{grip}</robot>"))
    player, twin = played(write(tmp_path / "bag", messages))
    player.advance_to(1.0)
    assert twin.robot_state("cart").positions == pytest.approx((0.25, 0.0))


def test_time_controls(tmp_path, played, caplog):
    player, twin = played(write(tmp_path / "bag", cart_messages()))

    def height():
        return twin.entities.state("cart::mast").position[2]

    player.do(protocol.Play())
    player.do(protocol.SetRate(2.0))
    player.proceed(0.1)
    assert player.time == pytest.approx(0.2)
    assert height() == pytest.approx(0.5 + 0.05)
    player.do(protocol.Pause())
    player.proceed(0.1)
    assert player.time == pytest.approx(0.2)
    player.do(protocol.Step(3))
    assert player.time == pytest.approx(0.3)
    player.do(protocol.RunTo(0.5))
    for _ in range(10):
        player.proceed(0.05)
    assert (player.time, player.paused) == (0.5, True)
    with pytest.raises(InputError, match=r"0.2 s lies in the past"):
        player.do(protocol.RunTo(0.2))
    player.do(protocol.Look(0.2))
    assert (player.time, player.paused) == (0.2, True)
    assert height() == pytest.approx(0.5 + 0.05)
    player.do(protocol.Look(9.0))
    assert player.time == 2.0
    player.do(protocol.Reset())
    assert player.time == 0.0
    assert height() == pytest.approx(0.5)
    player.do(protocol.SetRate(100.0))
    player.do(protocol.Play())
    player.proceed(0.1)
    assert (player.time, player.paused) == (2.0, True)
    assert caplog.messages == ["the bag ends at 2.000 s"]
    assert height() == pytest.approx(1.0)
    player.do(protocol.Play())
    assert (player.time, player.paused) == (0.0, False)
    with pytest.raises(InputError, match="EmergencyStop: a bag is only shown"):
        player.do(protocol.EmergencyStop("cart"))
    with pytest.raises(InputError, match="0 is not a speed"):
        player.do(protocol.SetRate(0.0))


def test_a_bag_that_is_looked_at_again_shows_the_same(tmp_path, played):
    """Of a joint that the messages stop to name, and in a frame that is known late, nothing stays from a later time."""

    def messages():
        yield from cart_messages()
        yield "/tf", TRANSFORMS, 2.5, transforms(("world", "map", (0, 0, 7), (0, 0, 0, 1), 2.5))

    player, twin = played(write(tmp_path / "bag", messages()))
    player.advance_to(0.0)
    first = twin.entities.state("cart").position, twin.entities.state("cart::mast").position
    player.do(protocol.Look(2.5))
    assert twin.entities.state("cart").position[2] == pytest.approx(7.5)
    player.do(protocol.Look(0.0))
    again = twin.entities.state("cart").position, twin.entities.state("cart::mast").position
    np.testing.assert_allclose(again, first, atol=1e-12)


def test_a_pause_of_the_end_begins_anew_and_one_before_goes_on(tmp_path, played):
    player, _ = played(write(tmp_path / "bag", cart_messages()))
    player.do(protocol.Play())
    player.proceed(0.5)
    middle = player.time
    assert 0.0 < middle < 2.0
    player.do(protocol.Pause())
    player.do(protocol.Play())
    assert player.time == middle


def test_a_topic_for_all_robots_moves_each_of_them(tmp_path, played):
    """Two carts in namespaces, and the joint states of both on one topic of neither."""

    def messages():
        for name in ("one", "two"):
            text = CART.replace('"cart"', f'"{name}"').replace('"lift"', f'"{name}_lift"')
            text = text.replace('"base"', f'"{name}_base"').replace('"mast"', f'"{name}_mast"')
            yield f"/{name}/robot_description", TEXT, 0.0, make(TEXT, {"data": text})
        yield "/all/joint_states", STATES, 0.5, joints(one_lift=0.25, two_lift=0.5)

    player, twin = played(write(tmp_path / "bag", messages()))
    player.advance_to(0.5)
    heights = [
        twin.entities.state(f"{name}::{name}_mast").position[2] - twin.entities.state(name).position[2]
        for name in ("one", "two")
    ]
    assert heights == pytest.approx([0.25, 0.5])
    assert player.unplaced == [("one", "one_base"), ("two", "two_base")]


def test_what_is_not_understood_is_said_once(tmp_path, played, caplog):
    def messages():
        yield from cart_messages()
        for seconds in (2.1, 2.2):
            yield "/tf", TRANSFORMS, seconds, transforms(("odom", "base", (0, 0, 0), (0, 0, 0, 0), seconds))
            yield "/joint_states", STATES, seconds, joints(wheel=1.0, lift=float("nan"))

    player, twin = played(write(tmp_path / "bag", messages()))
    player.advance_to(2.3)
    assert [line for line in caplog.messages if "ends at" not in line] == [
        "a transform of the frame 'base' is ignored: [0. 0. 0. 0. 0. 0. 0.]",
        "/joint_states: no robot of the bag has the joints wheel",
    ]
    assert twin.entities.state("cart::mast").position[2] == pytest.approx(1.0)  # as it was before


def test_robots_whose_frames_are_not_connected(tmp_path, played, caplog):
    def messages():
        for number in (1, 2):
            text = CART.replace('"base"', f'"base_{number}"').replace('"lift"', f'"lift_{number}"')
            yield f"/cart_{number}/robot_description", TEXT, 0.0, make(TEXT, {"data": text})
            item = (f"odom_{number}", f"base_{number}", (number, 0, 0), (0, 0, 0, 1), 0.1)
            yield "/tf", TRANSFORMS, 0.1, transforms(item)
        yield "/joint_states", STATES, 0.1, joints(lift_1=0.5, lift_2=0.25)

    player, twin = played(write(tmp_path / "bag", messages()))
    player.advance_to(0.0)
    assert player.unplaced == [("cart_1", "base_1"), ("cart_2", "base_2")]
    player.advance_to(0.1)
    assert player.unplaced == []
    assert "no transforms connect the frames odom_1, odom_2" in caplog.text
    np.testing.assert_allclose(twin.entities.state("cart_1::mast").position, [1, 0, 0.5], atol=1e-12)
    np.testing.assert_allclose(twin.entities.state("cart_2::mast").position, [2, 0, 0.25], atol=1e-12)


def test_the_program(tmp_path, capsys):
    folder = write(tmp_path / "bag", cart_messages())
    assert main([str(folder), "--no-browser", "--end", "--rate", "20"]) == 0
    captured = capsys.readouterr()
    first, second = captured.out.splitlines()
    assert first == "bag: 2.000 s from 1700000000.000 s on; robots: cart"
    assert second.startswith("page: http://127.0.0.1:")
    said, ended = captured.err.splitlines()
    assert said == "not in the scene, but under Sensors and ROS: /chatter (std_msgs/msg/String, 1)"
    assert ended == "warning: the bag ends at 2.000 s"
    assert main([str(next(folder.glob("*.db3"))), "--no-browser", "--end", "--rate", "20"]) == 0


def test_descriptions_are_not_expanded_for_expressions_are_code(tmp_path, played):
    folder = write(tmp_path / "bag", cart_messages(text=CART.replace('"mast"', '"${1 + 1}"')))
    _, twin = played(folder)
    assert "${1 + 1}" in twin.built.plans[0].description.links


def refused(capsys, *arguments):
    assert main([*map(str, arguments), "--no-browser"]) == 2
    captured = capsys.readouterr()
    assert captured.err.startswith("error: ")
    assert captured.err.count("\n") == 1
    return captured.err


def test_what_is_refused(tmp_path, capsys):
    assert "the bag does not exist" in refused(capsys, tmp_path / "nothing")
    (tmp_path / "empty").mkdir()
    assert "this is not a rosbag2 bag: it has no metadata.yaml" in refused(capsys, tmp_path / "empty")
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0\n")
    assert "this is a bag of ROS 1" in refused(capsys, tmp_path / "old.bag")
    others = [item for item in cart_messages() if "description" not in item[0]]
    assert "the bag has no robot_description" in refused(capsys, write(tmp_path / "no_robot", others))
    text = [("/robot_description", TEXT, 0.0, make(TEXT, {"data": "<robot"}))]
    assert "/robot_description is not XML" in refused(capsys, write(tmp_path / "no_xml", text))
    assert "the bag holds no messages" in refused(capsys, write(tmp_path / "no_messages", []))
    assert "--rate 0 is not a positive number" in refused(capsys, tmp_path, "--rate", 0)
    meshes = CART.replace('<box size="1 1 1"/>', '<mesh filename="package://nobodys/meshes/a.stl"/>')
    assert (
        main([str(write(tmp_path / "mesh", cart_messages(text=meshes))), "--no-browser", "--end", "--rate", "20"]) == 0
    )
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith("mended: cart: ")
    assert "[missing_mesh]" in said[0]
    assert len(said) == 3


def damaged(tmp_path, name, change):
    folder = tmp_path / name
    shutil.copytree(tmp_path / "bag", folder)
    change(folder)
    return folder


@pytest.mark.parametrize("plugin", [StoragePlugin.SQLITE3, StoragePlugin.MCAP])
def test_damaged_bags(tmp_path, capsys, plugin):
    write(tmp_path / "bag", cart_messages(), plugin)

    def data(folder):
        return next(file for file in folder.iterdir() if file.suffix in (".db3", ".mcap"))

    def cut(folder):
        content = data(folder).read_bytes()
        data(folder).write_bytes(content[: len(content) // 2])

    said = refused(capsys, damaged(tmp_path, "cut", cut))
    assert "the bag cannot be read" in said
    said = refused(capsys, damaged(tmp_path, "no_data", lambda folder: data(folder).unlink()))
    assert "the bag cannot be read" in said
    said = refused(capsys, damaged(tmp_path, "yaml", lambda folder: (folder / "metadata.yaml").write_text("a: [")))
    assert "the bag cannot be read" in said


def test_a_message_that_is_damaged_ends_the_bag_there(tmp_path, played, caplog):
    def messages():
        yield from list(cart_messages())[:12]
        yield "/tf", TRANSFORMS, 1.5, b"\x00\x01\x00\x00\xff\xff\xff\x7f"
        yield "/chatter", TEXT, 2.0, make(TEXT, {"data": "hello"})

    player, _ = played(write(tmp_path / "bag", messages()))
    player.paused = False
    player.advance_to(1.0)
    before = player.time
    player.advance_to(1.6)
    assert player.paused
    assert player.time == before
    (line,) = caplog.messages
    assert "the bag cannot be read" in line
    assert line.endswith("The bag ends here, at 1.000 s")


def test_each_moment_is_the_same_by_whatever_way_it_is_reached(tmp_path, played):
    def extended():
        yield from cart_messages()
        for index in range(21, 80):  # which goes on, in messages that tell a part only
            seconds = index / 10
            moved = ("odom", "base", (seconds, 0.0, 0.5), (0.0, 0.0, 0.0, 1.0), seconds)
            yield "/tf", TRANSFORMS, seconds, transforms(moved)
            if index % 7 == 0:
                yield "/joint_states", STATES, seconds, joints(lift=seconds / 20)

    folder = write(tmp_path / "bag", sorted(extended(), key=lambda item: item[2]))
    player, twin = played(folder)
    times = [0.0, 0.35, 1.0, 2.6, 4.0, 5.55, 7.9]

    def at(time):
        player.look(time)
        return [*twin.entities.state("cart::mast").position, player.time]

    straight = {time: at(time) for time in times}
    assert len(player._moments) > 4
    for time in (7.9, 0.0, 4.0, 0.35, 5.55, 2.6, 7.9, 1.0):
        assert at(time) == straight[time]
    other, _ = played(folder)
    other.look(2.6)
    assert other.time == 2.6
