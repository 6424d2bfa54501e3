"""gz-sim's Hydrodynamics on its own: its ports, the response of links, and what a file may say."""

from math import nan

import numpy as np
import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of
from waters import box, hydrodynamics, twin_of

from drake_twin.controllers.hydrodynamics import Hydrodynamics
from drake_twin.controllers.link_response import LinkResponse
from drake_twin.description.gazebo_drive import HYDRODYNAMICS
from drake_twin.errors import CommandError, InputError
from drake_twin.messages.interface_types import make

SIZE = (1.0, 0.4, 0.3)


def running(**parameters):
    values = parameters_of(HYDRODYNAMICS, link_name="palm", **parameters)
    return Running(Hydrodynamics(setup_of(Hydrodynamics, values)), ocean_current=None)


def current(x, y, z):
    return make("geometry_msgs/msg/Vector3", {"x": x, "y": y, "z": z})


def signals(run):
    return run.controller.GetOutputPort("signals").Eval(run.context).tolist()


def test_the_current_is_that_of_the_parameters_until_a_message_comes():
    run = running(default_current=[0.1, 0.2, 0.3])
    assert signals(run) == [0.1, 0.2, 0.3]
    run.send("ocean_current", current(1.0, 0.0, -1.0))
    assert signals(run) == [1.0, 0.0, -1.0]


def test_a_current_that_is_not_finite_is_refused():
    run = running()
    with pytest.raises(CommandError, match="ocean_current: the velocity is not finite"):
        run.send("ocean_current", current(1.0, nan, 0.0))


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        ({"coefficients": {"xX": 1.0}}, "'xX' is not a coefficient, as xU, xUabsU, xUV or xDotU are"),
        ({"coefficients": {"xU": nan}}, "xU is nan, which is not finite"),
        ({"default_current": [1.0]}, "default_current has to have 3 numbers"),
        ({"fluid_added_mass": [1.0] * 6}, "fluid_added_mass has to have 36 numbers"),
    ],
)
def test_parameters_that_are_refused(parameters, says):
    with pytest.raises(InputError, match=says):
        running(**parameters)


def vehicle(folder, plugin, more=""):
    return twin_of(folder, "", 0.01, {"auv": (box("auv", SIZE, 1000.0, more=more + plugin), (0, 0, 0))})


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"xU": "many"}, "<xU> is 'many', which is not"),
        ({"default_current": "1 2"}, "<default_current> is '1 2', which is not three finite numbers"),
        ({"disable_coriolis": "perhaps"}, "<disable_coriolis> is 'perhaps', which is neither true nor false"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_values_that_are_refused_with_file_and_line(tmp_path, elements, says):
    with pytest.raises(InputError) as refusal:
        vehicle(tmp_path, f"\n{hydrodynamics(**elements)}")
    assert str(refusal.value).startswith(f"{tmp_path / 'auv.sdf'}:4: ")
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_coefficients_that_drive_a_link_are_named(tmp_path):
    twin = vehicle(tmp_path, hydrodynamics(zW=2, xUabsU=3.5, yDotV=1, xU=-1, xV=1, xUV=1, yUabsV=1))
    said = [item.what.partition(": ")[2] for item in twin.findings if "SNAME" in item.what]
    assert said == [
        "<zW> is 2 and drives the link, as in gz-sim: damping is negative in SNAME's notation",
        "<xUabsU> is 3.5 and drives the link, as in gz-sim: damping is negative in SNAME's notation",
        "<yDotV> is 1 and takes mass from the link, as in gz-sim: added mass is negative in SNAME's notation",
    ]


def test_a_force_of_one_sign_for_both_directions_is_named(tmp_path):
    """gz-sim warns of it too: what is meant is xUabsU."""
    twin = vehicle(tmp_path, hydrodynamics(xUU=-3, mQQ=0, nRabsR=-4, xUV=-1))
    (said,) = (item.what.partition(": ")[2] for item in twin.findings if "one sign" in item.what)
    assert said == "<xUU> is -3, a force of one sign for both directions, as in gz-sim: <xUabsU> has two"


@pytest.mark.parametrize(
    ("library", "elements", "is_braked"),
    [
        ("ignition-gazebo-hydrodynamics-system", {"mQQ": -5}, True),
        ("libignition-gazebo-hydrodynamics-system.so", {"mQQ": -5, "xUV": -1}, True),
        ("ignition-gazebo-hydrodynamics-system", {"mQQ": -5, "xUabsU": -1}, False),
        ("gz-sim-hydrodynamics-system", {"mQQ": -5}, False),
    ],
)
def test_of_fortress_a_quadratic_coefficient_takes_the_size_of_its_velocity(tmp_path, library, elements, is_braked):
    plugin = hydrodynamics(**elements).replace("gz-sim-hydrodynamics-system", library)
    twin = vehicle(tmp_path, plugin)
    twin.entities.set_state("auv", angular=(0.0, -1.0, 0.0))
    twin.advance_to(1.0)
    assert (abs(twin.entities.state("auv").angular[1]) < 1.0) is is_braked
    assert any("one sign" in item.what for item in twin.findings) is not is_braked


def test_an_added_mass_that_takes_all_of_the_mass_is_refused(tmp_path):
    vehicle(tmp_path, hydrodynamics(zDotW=119))
    with pytest.raises(InputError, match="robot 'auv': controller hydrodynamics: the added mass of link 'hull' "):
        vehicle(tmp_path, hydrodynamics(zDotW=121))


@pytest.mark.parametrize("link", ["keel", ""])
def test_what_does_nothing_in_gazebo_is_said(tmp_path, link):
    twin = vehicle(tmp_path, hydrodynamics(link))
    (finding,) = (str(item) for item in twin.findings if "hydrodynamics" in str(item))
    assert ("the robot has no link 'keel'" if link else "<link_name> is missing") in finding


def test_without_a_namespace_all_hear_one_topic(tmp_path):
    twin = vehicle(tmp_path, hydrodynamics(xU=-1, lookup_current_x="east"))
    assert "/ocean_current" in twin.graph.topics()
    (finding,) = (item.what for item in twin.findings if "lookup" in item.what)
    assert finding == "<lookup_current_x> of Gazebo plugin hydrodynamics"


ARM = """<link name="arm"><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.3</izz></inertia>
</inertial></link><joint name="j" type="continuous"><parent>hull</parent><child>arm</child><axis><xyz>0 0 1</xyz></axis>
</joint>"""


def test_a_link_answers_as_the_mechanism_that_it_belongs_to(tmp_path):
    """The arm turns about its hinge with its own inertia, and moves with the mass of both."""
    plant = vehicle(tmp_path, "", ARM).plant
    instance = plant.GetModelInstanceByName("auv")
    hull, arm = (plant.GetBodyByName(name, instance) for name in ("hull", "arm"))
    response = LinkResponse(plant, [hull, arm])
    assert response.own[1, 2, 2] == pytest.approx(1 / 0.3)
    assert response.own[:, 3:, 3:] == pytest.approx(np.broadcast_to(np.eye(3) / 122, (2, 3, 3)))
    (members,), (together,) = response.groups, response.responses
    assert members.tolist() == [[0, 1]]
    assert together[0, 3:6, 9:] == pytest.approx(np.eye(3) / 122)  # a force on the arm moves the hull
    assert [body.name() for body in response.carried] == ["hull", "arm"] * 2


def test_a_link_that_is_welded_to_the_world_answers_nothing(tmp_path):
    plant = twin_of(tmp_path, "").plant
    link = plant.GetBodyByName("top", plant.GetModelInstanceByName("post"))
    assert not LinkResponse(plant, [link]).own.any()


def floating(added, more=""):
    inertial = f"<inertial><mass>2</mass><fluid_added_mass>{added}</fluid_added_mass></inertial>"
    return f'<model name="buoy"><link name="hull">{inertial}</link>{more}</model>'


@pytest.mark.parametrize("more", ["", hydrodynamics(yDotV=-1)])
def test_a_link_with_sdfs_added_mass_accelerates_as_with_that_mass_beside_a_plugins(tmp_path, more):
    twin = twin_of(tmp_path, "<gravity>0 0 0</gravity>", 0.01, {"buoy": (floating("<yy>5</yy>", more), (0, 0, 0))})
    twin.entities.apply_wrench("buoy", force=(0.0, 7.0, 0.0), duration=1.0)
    twin.advance_to(1.0)
    assert twin.entities.state("buoy").linear == pytest.approx((0.0, 7.0 / (8.0 if more else 7.0), 0.0))
    assert not [item for item in twin.findings if "added" in item.what]


def test_sdfs_added_mass_that_is_no_number_is_refused_with_file_and_line(tmp_path):
    with pytest.raises(InputError) as refusal:
        twin_of(tmp_path, "", 0.01, {"buoy": (floating("\n<yy>much</yy>"), (0, 0, 0))})
    assert str(refusal.value).startswith(f"{tmp_path / 'buoy.sdf'}:1: ")
    assert "<yy> of the link's added mass is 'much'" in str(refusal.value)


@pytest.mark.parametrize(
    ("elements", "is_said"),
    [
        ({"xDotU": -5, "yDotV": -126, "zDotW": -126}, True),
        ({"xDotU": -5, "yDotV": -126, "disable_coriolis": 1}, False),
        ({"xDotU": -5, "yDotV": -5, "zDotW": -3}, False),
    ],
)
def test_a_hull_that_its_added_mass_turns_across_is_a_finding(tmp_path, elements, is_said):
    found = [item for item in vehicle(tmp_path, hydrodynamics(**elements)).findings if "Coriolis" in item.what]
    assert len(found) == is_said
    if is_said:
        assert "<yDotV> of -126 is more than <xDotU>: its Coriolis forces turn a hull" in found[0].what
        assert found[0].lines
