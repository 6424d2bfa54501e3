"""Those that meet: they share a plant before they touch, and go on as in one plant."""

import numpy as np
import pytest
from crates import archipelago, crates, drive, groups, model, pose, quaternion, state, with_rovers

STEP = 0.001


def fly(twin, name, position, rpy, linear, angular):
    twin.entities.set_state(name, position, quaternion(rpy), linear, angular)


def collision(seed):
    """Two crates far from each other, that meet after 0.2 s or later at up to 10 m/s each."""
    rng = np.random.default_rng(seed)
    found, meeting = {}, 0.2 + rng.uniform(0, 0.1)
    for name in ("one", "other"):
        linear = rng.normal(size=3)
        linear *= rng.uniform(3, 10) / np.linalg.norm(linear)
        middle = rng.uniform(-0.1, 0.1, 3)  # the blow is not central
        found[name] = (middle - linear * meeting, rng.uniform(-3, 3, 3), linear, rng.uniform(-3, 3, 3))
    return found


def collided(folder, seed, islands):
    models = (model("one", (0, 0, 0), mass=2.0), model("other", (5, 0, 0), size=(0.5, 0.3, 0.4), mass=3.0))
    twin = crates(folder, *models, gravity=0, ground=False, time_step=STEP, islands=islands, threads=1).build()
    for name, (position, rpy, linear, angular) in collision(seed).items():
        fly(twin, name, position, rpy, linear, angular)
    return twin


def momentum(twin):
    mass = {"one": 2.0, "other": 3.0}
    return sum(mass[name] * np.array(twin.entities.state(name).linear) for name in mass)


@pytest.mark.parametrize("seed", range(8))
def test_crates_that_fly_at_each_other_collide_as_in_one_plant(tmp_path, seed):
    twins = [collided(tmp_path, seed, islands) for islands in (1, 0)]
    before, start = momentum(twins[0]), state(twins[0])
    together, touched = False, False
    while twins[0].time < 0.6:
        for twin in twins:
            twin.advance_to(twin.time + 0.01)
        one, other = map(state, twins)
        touched = touched or not np.allclose(other[-12:], start[-12:], atol=1e-3)
        if not touched:
            assert one == pytest.approx(other, abs=1e-9)
        else:
            assert one == pytest.approx(other, abs=1e-6)
        together = together or groups(twins[0]) == [("one", "other")]
    assert touched
    assert together
    assert momentum(twins[0]) == pytest.approx(before, abs=1e-9)


def test_crates_of_ten_metres_a_second_do_not_pass_through_each_other(tmp_path):
    for angle in np.linspace(0, 1.2, 5):
        models = (model("one", (-1.03, 0, 0), size=(0.1, 0.4, 0.4)), model("other", (1.03, 0, 0), size=(0.1, 0.4, 0.4)))
        twin = crates(tmp_path, *models, gravity=0, ground=False, time_step=STEP, islands=1, threads=1).build()
        for name, sign in (("one", 1), ("other", -1)):
            way = np.array([np.cos(angle), np.sin(angle), 0])
            fly(twin, name, -sign * 1.03 * way, (0, 0, angle), 10 * sign * way, (0, 0, 0))
        twin.advance_to(0.5)
        gap = (pose(twin, "other") - pose(twin, "one"))[:2] @ [np.cos(angle), np.sin(angle)]
        assert gap > 0.09


def test_what_a_heavy_fast_one_hits_meets_the_next_one(tmp_path):
    """It is slow, or at rest, when it is seen, and leaves at up to twice the speed of what hits it."""
    models = (
        model("heavy", (-1.0, 0, 0), mass=200),
        model("light", (0, 0, 0), size=(0.1, 0.1, 0.1), mass=0.2),
        model("last", (0.2, 0, 0), size=(0.01, 0.5, 0.5), mass=5),
    )
    twins = [
        crates(tmp_path, *models, gravity=0, ground=False, time_step=STEP, islands=islands, threads=1).build()
        for islands in (1, 0)
    ]
    for twin in twins:
        twin.advance_to(1.0)
        twin.entities.set_state("heavy", linear=(10, 0, 0))
        twin.advance_to(1.3)
    assert state(twins[0]) == pytest.approx(state(twins[1]), abs=1e-6)
    x = [pose(twins[0], name)[0] for name in ("heavy", "light", "last")]
    assert x == sorted(x)
    assert x[2] > 0.3


def test_those_that_a_blow_may_send_on_share_the_plant_of_what_they_may_meet(tmp_path):
    models = (model("heavy", (-0.26, 0, 0), mass=200), model("light", (0, 0, 0), size=(0.1,) * 3, mass=0.2))
    for x, together in ((0.4, True), (0.9, False)):
        last = model("last", (x, 0, 0), size=(0.1, 0.5, 0.5))
        twin = crates(tmp_path, *models, last, gravity=0, ground=False, islands=1, threads=1).build()
        twin.entities.set_state("heavy", linear=(10, 0, 0))
        twin.step()
        assert groups(twin) == ([("heavy", "light", "last")] if together else [("heavy", "light"), ("last",)])


def test_a_train_of_crates_is_one_island_and_the_others_are_alone(tmp_path):
    train = [model(f"wagon_{index}", (0.4 * index, 0, 0.2)) for index in range(8)]
    twin = crates(tmp_path, *train, model("far", (0, 9, 0.2)), islands=1, threads=1).build()
    twin.step()
    assert archipelago(twin)._groups == (tuple(range(8)), (8,))
    assert groups(twin)[1] == ("far",)


def test_those_that_are_alone_share_islands_of_as_many_as_may_be(tmp_path):
    alone = [model(f"m{index}", (5 * index, 0, 0.2)) for index in range(7)]
    twin = crates(tmp_path, *alone, islands=3, threads=1).build()
    twin.step()
    assert [len(group) for group in groups(twin)] == [3, 3, 1]


def test_rovers_that_push_a_heap_together_move_as_in_one_plant(tmp_path):
    heap = [model(f"h{index}", (0.45 * (index % 2), 0.45 * (index // 2), 0.1), size=(0.2,) * 3) for index in range(4)]
    turns = 2 * np.pi * np.arange(10) / 10
    around = [(0.2 + 2.2 * np.cos(turn), 0.2 + 2.2 * np.sin(turn), turn + np.pi) for turn in turns]
    twins = []
    for islands in (1, 0):
        twin = with_rovers(crates(tmp_path, *heap, islands=islands, threads=1), *around).build()
        for index in range(10):
            drive(twin, f"r{index}", 8.0)
        twin.advance_to(1.6)
        twins.append(twin)
    names = [*(f"r{index}" for index in range(10)), *(f"h{index}" for index in range(4))]
    assert state(twins[0]) == pytest.approx(state(twins[1]), abs=1e-6)
    # From the first blow on a difference grows a hundredfold each half second: from rounding, or from anything else.
    for time, most in ((1.8, 1e-3), (2.2, 0.02)):
        for twin in twins:
            twin.advance_to(time)
        places = [np.array([pose(twin, name)[:3] for name in names]) for twin in twins]
        assert places[0] == pytest.approx(places[1], abs=most)
    assert max(map(len, groups(twins[0]))) >= 12
    assert np.linalg.norm(places[0][:10] - places[0][0], axis=1)[1:].min() > 0.3


def test_a_lidar_sees_what_moves_in_another_island(tmp_path):
    tall = {"size": (0.5, 0.5, 1.2), "mass": 5.0}
    models = (model("post", (0, 2.5, 0.6), **tall), model("slider", (4, -1, 0.6), mu=0.05, **tall))
    scans = []
    for islands in (1, 0):
        twin = with_rovers(
            crates(tmp_path, *models, islands=islands, threads=1), (0, 0, 0), xacro_args={"lidar": "true"}, noise=0.0
        ).build()
        found: list = []
        twin.subscribe("/r0/r0/scan", lambda message, found=found: found.append(message.ranges))
        twin.entities.set_state("slider", linear=(0, 2, 0))
        twin.advance_to(1.0)
        scans.append(np.array(found))
        if islands:
            assert len(groups(twin)) == len({name for group in groups(twin) for name in group})
    one, other = scans
    assert len(one) >= 10
    assert (np.isfinite(one) == np.isfinite(other)).all()
    seen = np.isfinite(one)
    assert one[seen] == pytest.approx(other[seen], abs=1e-4)
    assert (seen[0] & seen[-1]).any()
    assert (seen[0] != seen[-1]).sum() > 5


FEELER = """<robot name="feeler"><link name="box"><inertial><mass value="2"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>
<gazebo reference="box"><sensor name="s" type="contact"><contact><collision>box_collision</collision></contact>
</sensor></gazebo></robot>"""


def contacts(message):
    """What touches what, and with what forces (N) and depths (m)."""
    if message is None:
        return [], []
    pairs = [(item.collision1.name, item.collision2.name) for item in message.contacts]
    forces = [wrench.body_1_wrench.force for item in message.contacts for wrench in item.wrenches]
    depths = [depth for item in message.contacts for depth in item.depths]
    return pairs, [value for force in forces for value in (force.x, force.y, force.z)] + depths


def test_a_contact_sensor_feels_what_comes_from_another_island(tmp_path):
    (tmp_path / "feeler.urdf").write_text(FEELER, encoding="utf-8")
    found = []
    for islands in (1, 0):
        builder = crates(tmp_path, model("crate", (0.9, 0, 0.2)), islands=islands, threads=1)
        twin = builder.robot("feeler", tmp_path / "feeler.urdf", xyz=(0, 0, 0.1)).build()
        if islands:
            twin.step()
            assert sorted(groups(twin)) == [("crate",), ("feeler",)]
        twin.advance_to(0.3)
        twin.entities.set_state("crate", linear=(-6, 0, 0))
        messages = []
        while twin.time < 0.7:
            twin.advance_to(twin.time + 0.01)
            messages.append(contacts(twin.latest("/feeler/s/contact")))
        found.append(messages)
    assert any("crate::link::c" in name for pairs, _ in found[0] for pair in pairs for name in pair)
    for (pairs, values), (others, expected) in zip(*found, strict=True):
        assert pairs == others
        assert values == pytest.approx(expected, rel=1e-5, abs=1e-4)
