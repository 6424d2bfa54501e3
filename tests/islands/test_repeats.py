"""The same bits, whatever else is done: threads, snapshots, replays, and where an advance is cut."""

import numpy as np
import pytest
from crates import archipelago, crates, drive, groups, model, resting, state, with_rovers

from drake_twin import Rewind, replay

END = 2.8
PROGRAM = {0.9: ("r0", 6.0), 1.3: ("r1", -4.0), 2.4: ("r2", 3.0), 2.6: ("r0", 0.0)}


def builder(folder, islands=1, threads=1, **options):
    """Rovers of which one drives into a resting crate, one stays long, and a crate that falls on a resting one."""
    models = (
        model("pushed", (1.0, 0, 0.15), size=(0.3, 0.6, 0.3), mass=0.5),
        model("still", (-3, 5, 0.2)),
        model("falling", (-3.1, 5.05, 7.5)),
        model("thrown", (6, -6, 0.3)),
        model("hit", (6.05, -2, 0.2)),
    )
    found = crates(folder, *models, islands=islands, threads=threads, **options)
    return with_rovers(found, (0.2, 0, 0), (0, 3, 0.4), (0, -3, 0))


def start(folder, **options):
    twin = builder(folder, **options).build()
    twin.entities.set_state("thrown", linear=(0, 7, 4), angular=(3, 0, 60))
    return twin


def go(twin, end, advance=lambda twin, time: twin.advance_to(time)):
    """Advance with the program's commands, each at its time."""
    for time, (robot, speed) in PROGRAM.items():
        if twin.time <= time < end:
            advance(twin, time)
            drive(twin, robot, speed)
    advance(twin, end)
    return twin.state_sha256()


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The hashes of a run at some times, and of its end."""
    twin = start(tmp_path_factory.mktemp("expected"))
    seen = set()
    for time in np.arange(0.05, END, 0.05):
        go(twin, float(time))
        seen |= {group for group in groups(twin) if len(group) > 1}
        if 0.7 < time < 0.85:
            assert {"still", "r1"} <= resting(twin)
    assert {name for group in seen for name in group} >= {"r0", "pushed", "still", "falling", "thrown", "hit"}
    return go(twin, END)


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_any_number_of_threads_gives_the_same_bits(tmp_path, expected, threads):
    assert go(start(tmp_path, threads=threads), END) == expected


def in_pieces(size):
    def advance(twin, time):
        while twin.time + size < time:
            twin.advance_to(twin.time + size)
        twin.advance_to(time)

    return advance


def single_steps(twin, time):
    while twin.time < time - 1e-9:
        twin.step()


def reading_efforts(twin, time):
    while twin.time < time - 1e-9:
        twin.step(7) if twin.time + 0.014 < time else twin.step()
        twin.robot_state("r0")
        twin.robot_state("r2")


def reading_hashes(twin, time):
    while twin.time < time - 1e-9:
        twin.step(3) if twin.time + 0.006 < time else twin.step()
        twin.state_sha256()


@pytest.mark.parametrize("advance", [in_pieces(0.0137), in_pieces(0.31), single_steps, reading_efforts, reading_hashes])
def test_where_an_advance_is_cut_and_what_is_read_there_is_no_matter(tmp_path, expected, advance):
    assert go(start(tmp_path), END, advance) == expected


def test_what_is_subscribed_is_no_matter(tmp_path, expected):
    twin = start(tmp_path)
    heard = []
    for topic, rate in (("/r0/joint_states", 37.0), ("/r1/joint_states", 500.0), ("/tf", 11.0), ("/model_states", 60)):
        twin.subscribe(topic, heard.append, rate)
    assert go(twin, END) == expected
    assert len(heard) > 1000


@pytest.mark.parametrize("time", [0.104, 0.502, 0.9, 1.31, 2.598])
def test_a_run_goes_on_from_a_snapshot_in_another_twin(tmp_path, expected, time):
    """At times on and off the grid on which movers are put together."""
    twin, other = start(tmp_path), builder(tmp_path).build()
    go(twin, time)
    moment = twin.snapshot()
    other.restore(moment)
    assert other.state_sha256() == twin.state_sha256()
    assert go(other, END) == expected


def test_a_chain_of_snapshots_gives_the_same_bits(tmp_path, expected):
    twin, other = start(tmp_path), builder(tmp_path).build()
    for time in np.arange(0.138, END, 0.138):
        go(twin, float(time))
        other.restore(twin.snapshot())
        twin, other = other, twin
    assert go(twin, END) == expected


def test_a_rewound_run_gives_the_same_bits(tmp_path, expected):
    twin = start(tmp_path)
    with Rewind(twin) as rewind:
        go(twin, 2.1)
        for time in (1.2, 0.6, 1.7):
            rewind.go_to(time)
            assert twin.time <= time
            go(twin, 2.1)
        rewind.go_to(0.7)
        assert go(twin, END) == expected


def test_a_replay_gives_the_same_bits(tmp_path, expected):
    twin = builder(tmp_path).build()
    twin.recorder.begin()
    twin.entities.set_state("thrown", linear=(0, 7, 4), angular=(3, 0, 60))
    assert go(twin, END) == expected
    assert replay(twin.recorder.recording()).state_sha256() == expected


def test_a_reset_gives_the_same_bits(tmp_path, expected):
    twin = start(tmp_path)
    go(twin, 1.234)
    twin.reset()
    twin.entities.set_state("thrown", linear=(0, 7, 4), angular=(3, 0, 60))
    assert go(twin, END) == expected


# What is done to someone at rest is in a snapshot before the next step.


def move(twin):
    twin.entities.set_state("still", position=(9, 9, 2))


def command(twin):
    drive(twin, "r1", 3.0)


def push(twin):
    twin.entities.apply_wrench("still", force=(1.0, 0, 0), duration=0.101)


def switch(twin):
    twin.control.manager("r1").switch_controller(deactivate=["forward_velocity_controller"])


def let_go(twin):
    twin.control.clear_emergency_stop("r2")


def move_and_switch(twin):
    move(twin)
    switch(twin)
    twin.control.manager("r1").switch_controller(activate=["forward_velocity_controller"])


DEEDS = (move, command, push, switch, let_go, move_and_switch)


@pytest.mark.parametrize("deed", DEEDS)
def test_what_is_done_to_those_at_rest_is_in_a_snapshot(tmp_path, deed):
    time = 2.006  # within a frame
    models = (model("still", (-3, 5, 0.2)), model("upon", (-3, 5, 0.6)), model("far", (3, 9, 0.2)))
    twin, other, plain = (
        with_rovers(crates(tmp_path, *models, islands=1, threads=1), (0, 0, 0), (0, 3, 0), (0, -3, 0)).build()
        for _ in range(3)
    )
    for each in (twin, plain):
        drive(each, "r2", 2.0)
        each.advance_to(0.3)
        each.control.emergency_stop("r2")
        each.advance_to(time)
        assert resting(each) == {"still", "upon", "far", "r0", "r1", "r2"}
        deed(each)
    other.restore(twin.snapshot())
    assert other.state_sha256() == twin.state_sha256()
    hashes = []
    for each in (twin, other, plain):
        each.advance_to(time + 0.102)  # when the push ends
    late = builder_of_same(tmp_path, models)
    late.restore(twin.snapshot())
    for each in (twin, other, plain, late):
        each.advance_to(2.5)
        hashes.append(each.state_sha256())
    assert set(hashes) == {hashes[0]}


def builder_of_same(folder, models):
    return with_rovers(crates(folder, *models, islands=1, threads=1), (0, 0, 0), (0, 3, 0), (0, -3, 0)).build()


def test_what_is_moved_right_after_it_was_restored_falls(tmp_path):
    twin, other = (crates(tmp_path, model("crate", (0, 0, 0.2)), islands=1, threads=1).build() for _ in range(2))
    twin.advance_to(2.0)
    other.restore(twin.snapshot())
    other.entities.set_state("crate", position=(0, 0, 2))
    other.advance_to(2.2)
    assert other.entities.state("crate").linear[2] == pytest.approx(-9.81 * 0.2, rel=1e-2)


def flight(folder, seed):
    """Crates that fly past each other, turning, near and far."""
    rng = np.random.default_rng(seed)
    names = [f"m{index}" for index in range(9)]
    places = [(3.0 * (index % 3), 3.0 * (index // 3), 0.0) for index in range(9)]
    models = [model(name, place, size=rng.uniform(0.2, 0.7, 3)) for name, place in zip(names, places, strict=True)]
    twin = crates(folder, *models, gravity=0, ground=False, islands=2, threads=1).build()
    for name in names:
        twin.entities.set_state(name, linear=rng.uniform(-1.5, 1.5, 3), angular=rng.uniform(-15, 15, 3))
    return twin


@pytest.mark.parametrize("seed", range(4))
def test_who_shares_a_plant_follows_from_the_state_alone(tmp_path, seed):
    """A twin that is restored at each frame has always found the groups anew, and has the same."""
    twin, other = flight(tmp_path, seed), flight(tmp_path, seed)
    for frame in range(1, 60):
        for each in (twin, other):
            each.advance_to(0.02 * frame + 0.002)
        assert groups(twin) == groups(other), frame
        assert (state(twin) == state(other)).all()
        assert twin.state_sha256() == other.state_sha256()
        twin.advance_to(0.02 * (frame + 1))
        other.advance_to(0.02 * (frame + 1))
        other.restore(other.snapshot())
    assert archipelago(twin)._most == 2


def test_quaternions_that_are_halved_wake_nobody_and_cut_no_frame(tmp_path):
    """Who tumbles fast has a long one each second; when it is halved depends on where an advance is cut."""
    twins = []
    for size in (0.5, 0.002):
        models = [model(f"m{index}", (0.75 * (index % 3), 0.75 * (index // 3), 0)) for index in range(6)]
        twin = crates(tmp_path, *models, gravity=0, ground=False, islands=1, threads=1).build()
        for index in range(6):
            spin, drift = (0.2 * index, 0.1, 70.0 - 5 * index), (0.06 * np.cos(index), 0.06 * np.sin(index), 0)
            twin.entities.set_state(f"m{index}", linear=drift, angular=spin)
        in_pieces(size)(twin, 1.506)
        twins.append(twin)
    assert twins[0].state_sha256() == twins[1].state_sha256()
    assert groups(twins[0]) == groups(twins[1])


def test_who_comes_to_rest_beside_one_that_is_awake_has_the_same_bits_after_a_snapshot(tmp_path):
    """A light push that never ends keeps one awake; the other one's velocity becomes zero where it rests."""
    models = (model("leaning", (0, 0, 0.2)), model("upon", (0, 0, 0.6)))
    twin, other = (crates(tmp_path, *models, islands=1, threads=1).build() for _ in range(2))
    twin.entities.apply_wrench("leaning", force=(3.0, 0, 0), duration=100.0)
    twin.advance_to(0.4)
    while resting(twin) != {"upon"}:
        twin.advance_to(twin.time + 0.02)
        assert twin.time < 3.0
    assert groups(twin) == [("leaning", "upon")]
    other.restore(twin.snapshot())
    for _ in range(5):
        for each in (twin, other):
            each.step()
        assert (state(twin) == state(other)).all()
    assert twin.state_sha256() == other.state_sha256()
