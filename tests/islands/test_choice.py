"""When there are islands, what cannot be with them, and who takes whose place."""

import numpy as np
import pytest
from crates import crates, drive, model, with_rovers
from pydrake.systems.framework import BasicVector, LeafSystem

from drake_twin import TwinBuilder
from drake_twin.builder.demo import demo_scenario
from drake_twin.errors import InputError
from drake_twin.run import main
from drake_twin.scenario import World

TWO_LINKS = """<sdf version="1.9"><model name="m">
<link name="a"><inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
<link name="b"><pose>0 0 .5 0 0 0</pose>
<inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz><dynamics>
<spring_stiffness>{}</spring_stiffness><spring_reference>0.3</spring_reference></dynamics></axis></joint></model></sdf>"""


@pytest.mark.one_plant  # the choice itself is tested
def test_more_than_eight_robots_are_in_islands_by_default():
    assert [demo_scenario("rover", count).most_in_an_island for count in (1, 8, 9)] == [0, 0, 8]


@pytest.mark.one_plant
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--islands", "-3"), "islands: -3 is not a number from 0 to 1000"),
        (("--threads", "1001"), "threads: 1001 is not a number from 0 to 1000"),
        (("--islands", "2", "--engine", "cenic"), "islands: the engine cenic has all robots in one plant"),
    ],
)
def test_what_cannot_be_is_refused_in_a_paragraph(capsys, words, said):
    assert main(["--robots", "2", "--headless", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("name", ["reaction_forces", "contact_results", "net_actuation", "r0_net_actuation"])
def test_a_system_that_reads_what_only_islands_know_is_refused_by_its_name(tmp_path, name):
    def extend(builder, parts):
        system = LeafSystem()
        system.set_name("mine")
        port = parts.plant.GetOutputPort(name)
        own = system.DeclareAbstractInputPort("u", port.Allocate()) if port.size() == 0 else None
        builder.AddSystem(system)
        builder.Connect(port, own or system.DeclareVectorInputPort("u", BasicVector(port.size())))

    builder = with_rovers(crates(tmp_path, islands=1), (0, 0, 0)).system(extend)
    with pytest.raises(InputError, match=f"system 'mine' reads the plant's port '{name}'"):
        builder.build()


@pytest.mark.one_plant  # the choice itself is tested
def test_a_state_of_islands_is_refused_where_there_are_none(tmp_path):
    twin = crates(tmp_path, model("a", (0, 0, 0.2)), islands=1).build()
    twin.advance_to(1.0)
    snapshot = twin.snapshot()
    assert snapshot.islands
    text = "\n".join(line for line in snapshot.scenario.split("\n") if not line.startswith("islands"))
    snapshot = type(snapshot)(**{**snapshot.__dict__, "scenario": text})
    with pytest.raises(InputError, match="its robots are in islands"):
        crates(tmp_path, model("a", (0, 0, 0.2))).build().restore(snapshot)


def test_robots_of_the_same_numbers_with_other_springs_do_not_take_each_others_places(tmp_path):
    """In a plant each has its own spring: the harder one swings faster."""

    def swung(islands):
        builder = TwinBuilder(world=World(gravity=(0, 0, 0)), islands=islands)
        for index, stiffness in enumerate((1, 50)):
            file = tmp_path / f"{index}.sdf"
            file.write_text(TWO_LINKS.format(stiffness))
            builder.robot(f"robot_{index}", file, xyz=(0, 5 * index, 1))
        twin = builder.build()
        twin.advance_to(0.2)
        return [twin.robot_state(robot).positions[0] for robot in twin.robots]

    apart = swung(1)
    assert apart == pytest.approx(swung(0), abs=1e-9)
    assert abs(apart[0] - apart[1]) > 0.01


def test_rovers_of_one_file_take_each_others_places(tmp_path):
    builder = with_rovers(crates(tmp_path, islands=2), (0, 0, 0), (0, 3, 1), (0, 6, 2))
    store = builder.build()._session.physics.islands.archipelago._store
    assert len(set(store.kinds)) == 1


class Forces(LeafSystem):
    """Generalized forces of zero, which count how often they are set in an island."""

    def __init__(self, size):
        super().__init__()
        self.DeclareVectorOutputPort("y", size, lambda context, output: output.SetFromVector(np.zeros(size)))


def test_reading_efforts_does_not_set_inputs_again(tmp_path, monkeypatch):
    """A step that was solved for who reads its efforts is taken from the cache, unless an input is set anew."""
    from drake_twin.islands.island import Island

    def extend(builder, parts):
        system = builder.AddSystem(Forces(parts.plant.num_velocities()))
        builder.Connect(system.get_output_port(), parts.plant.get_applied_generalized_force_input_port())

    twin = with_rovers(crates(tmp_path, islands=1), (0, 0, 0)).system(extend).build()
    drive(twin, "r0", 2.0)
    twin.advance_to(0.1)
    found, is_new = [], Island._is_new

    def note(island, what, values, **options):
        found.append(is_new(island, what, values, **options))
        return found[-1]

    monkeypatch.setattr(Island, "_is_new", note)
    for _ in range(20):
        assert max(map(abs, twin.robot_state("r0").efforts)) > 0.0
        twin.step()
    assert len(found) > 20
    assert not any(found)


def test_threads_and_islands_are_options_of_a_program(capsys):
    ends = []
    for threads in ("1", "2"):
        words = ("--robots", "3", "--islands", "1", "--threads", threads, "--headless", "--duration", "0.1")
        assert main([*words]) == 0
        ends.append(capsys.readouterr().out.split()[-1])
    assert ends[0] == ends[1]
