"""gz-sim's LinearBatteryPlugin: charge, current and voltage under a constant power, as the closed forms have them."""

from math import exp, isnan, sqrt

import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of

from drake_twin import TwinBuilder, messages
from drake_twin.controllers.linear_battery import BatteryMemory, LinearBattery, drained
from drake_twin.description.gazebo_drive import LINEAR_BATTERY
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario import World

HOUR = 3600.0  # s
CELL = {
    "battery_name": "cell",
    "voltage": 12.0,
    "open_circuit_voltage_constant_coef": 12.0,
    "capacity": 0.02,
    "initial_charge": 0.02,
    "power_load": 24.0,
    "smooth_current_tau": 0.5,
    "fix_issue_225": True,
    "start_draining": True,
}


def after(time, time_step, memory=None, **changes):
    """A battery after a time (s) in steps (s)."""
    parameters = parameters_of(LINEAR_BATTERY, **CELL | changes)
    start = BatteryMemory(parameters.initial_charge, parameters.voltage, is_draining=parameters.start_draining)
    return drained(memory or start, parameters, time_step, round(time / time_step))


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_the_current_follows_the_load_and_the_charge_is_its_integral(time_step):
    """I = P/V · (1 − e^(−t/τ)), q = q0 − P/V · (t − τ · (1 − e^(−t/τ))), at a voltage of 12 V."""
    time, tau, current = 2.0, 0.5, 24.0 / 12.0
    battery = after(time, time_step)
    part = 1.0 - exp(-time / tau)
    assert battery.current == pytest.approx(current * part, rel=0.01)
    assert (0.02 - battery.charge) * HOUR == pytest.approx(current * (time - tau * part), rel=0.01)
    assert battery.level == pytest.approx(battery.charge / 0.02, rel=1e-12)
    assert battery.voltage == 12.0


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_the_voltage_falls_under_a_constant_power_as_a_root(time_step):
    """With E = e0 + e1·(1 − q/c) and I = P/E: E² = e0² + 2·e1·P·t/c, whose time constant is short."""
    battery = after(20.0, time_step, open_circuit_voltage_linear_coef=-6.0, smooth_current_tau=0.02)
    expected = sqrt(12.0**2 - 2.0 * 6.0 * 24.0 * 20.0 / (0.02 * HOUR))
    assert expected < 9.0
    assert battery.voltage == pytest.approx(expected, rel=0.01)
    assert battery.current == pytest.approx(24.0 / expected, rel=0.01)


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_resistance_takes_its_part_of_the_voltage(time_step):
    """V = E − R·P/V is V = (E + √(E² − 4·R·P)) / 2."""
    battery = after(5.0, time_step, resistance=0.5)
    assert battery.voltage == pytest.approx((12.0 + sqrt(12.0**2 - 4.0 * 0.5 * 24.0)) / 2.0, rel=0.01)


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_recharge_takes_the_hours_that_it_is_given(time_step):
    """The charging current is c / t: of 0.02 Ah in 0.01 h, 2 A, up to 90 %."""
    empty = BatteryMemory(0.0, 12.0, level=0.0, is_charging=True)
    battery = after(10.0, time_step, empty, charging_time=0.01)
    part = 1.0 - exp(-10.0 / 0.5)
    assert battery.charge * HOUR == pytest.approx(2.0 * (10.0 - 0.5 * part), rel=0.01)
    assert battery.current == pytest.approx(-2.0, rel=0.01)
    full = after(60.0, time_step, battery, charging_time=0.01)
    assert full.level == pytest.approx(0.9 + 2.0 * 0.5 / HOUR / 0.02, rel=0.01)  # the current ends as it began
    assert full.current == pytest.approx(0.0, abs=1e-6)


def test_the_older_level_counts_each_step_a_hundred_times():
    battery = after(1.0, 0.001, fix_issue_225=False, smooth_current_tau=0.001, capacity=10.0, initial_charge=10.0)
    counted = sum(min(number, 100) for number in range(1, 1001)) * 2.0 * 0.001
    assert 1.0 - battery.level == pytest.approx(counted / HOUR / 10.0, rel=1e-3)
    assert len(battery.currents) == 100


def test_an_empty_battery_keeps_what_it_has_until_it_is_recharged():
    empty = after(100.0, 0.01)
    assert empty.level < 0.0
    assert after(10.0, 0.01, empty) == empty
    dead = BatteryMemory(0.01, 0.0, is_draining=True)
    assert after(10.0, 0.01, dead).voltage == 0.0


def battery(**changes):
    parameters = parameters_of(LINEAR_BATTERY, **CELL | {"start_draining": False, "charging_time": 0.01} | changes)
    run = LinearBattery(setup_of(LinearBattery, parameters, physics_step=0.001))
    return Running(run, state=[0.0] * 4, commanded_motion=[0.0], draining=None, recharge_start=None, recharge_stop=None)


def test_messages_start_and_end_load_and_recharge_in_their_order():
    run = battery(initial_charge=0.001)
    run.advance(0.1)
    state = run.output("battery_state")
    assert (state.charge, state.voltage, state.capacity, state.present) == (0.001, 12.0, 0.02, True)
    assert isnan(state.temperature)
    assert state.power_supply_status == 3  # not charging
    run.send("draining", messages.Bool(True))
    run.advance(0.2)
    state = run.output("battery_state")
    assert state.power_supply_status == 2
    assert state.current == pytest.approx(2.0 * (1.0 - exp(-0.1 / 0.5)), rel=0.002)
    run.send("draining", messages.Bool(False))
    run.send("recharge_start", messages.Bool(False))
    run.advance(0.3)
    state = run.output("battery_state")
    assert state.power_supply_status == 1
    charge = state.charge
    run.send("recharge_start", messages.Bool(True))
    run.send("recharge_stop", messages.Bool(True))
    run.advance(0.4)
    state = run.output("battery_state")
    assert (state.power_supply_status, state.charge) == (3, charge)
    run.controller.deactivate(run.context)
    assert run.output("battery_state") is None


def test_the_sign_and_the_percentage_are_as_asked():
    run = battery(invert_current_sign=True, start_draining=True)
    run.advance(0.5)
    state = run.output("battery_state")
    assert state.current < 0.0
    assert state.percentage == pytest.approx(100.0 * state.charge / 0.02)
    full = battery(fix_issue_225=False)
    full.advance(0.1)
    state = full.output("battery_state")
    assert (state.percentage, state.power_supply_status) == (1.0, 4)


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"capacity": 0.0}, "capacity is 0, and has to be above zero"),
        ({"smooth_current_tau": -1.0}, "smooth_current_tau is -1, and has to be above zero"),
        ({"initial_charge": 0.03}, "initial_charge is 0.03, which is more than the capacity of 0.02"),
    ],
)
def test_bad_parameters_are_refused(changes, problem):
    with pytest.raises((ParameterError, InputError)) as raised:
        parameters_of(LINEAR_BATTERY, **CELL | changes)
    assert problem in str(raised.value)


CART = """<sdf version="1.9"><model name="cart"><link name="rail"/>
<joint name="to_world" type="fixed"><parent>world</parent><child>rail</child></joint>
<link name="mass"><inertial><mass>2</mass></inertial></link>
<joint name="slide" type="prismatic"><parent>rail</parent><child>mass</child><axis><xyz>1 0 0</xyz></axis></joint>
<plugin filename="gz-sim-{kind}-system" name="gz">
<joint_name>slide</joint_name><topic>/go</topic></plugin>
<plugin filename="gz-sim-linearbatteryplugin-system" name="gz::sim::systems::LinearBatteryPlugin">{elements}</plugin>
</model></sdf>"""
ELEMENTS = (
    "<battery_name>cell</battery_name><voltage>12</voltage><smooth_current_tau>0.01</smooth_current_tau>"
    "<open_circuit_voltage_constant_coef>12</open_circuit_voltage_constant_coef><capacity>0.02</capacity>"
    "<power_load>24</power_load><fix_issue_225>true</fix_issue_225>"
)
STATE = "/cart/battery/cell/state"


@pytest.fixture
def cart(tmp_path):
    """Builds a twin of a mass on a rail, with a battery."""

    def build(more="", elements=ELEMENTS, time_step=0.001, kind="joint-controller"):
        (tmp_path / "cart.sdf").write_text(CART.format(elements=elements + more, kind=kind))
        builder = TwinBuilder(world=World(), time_step=time_step)
        return builder.robot("cart", tmp_path / "cart.sdf", xyz=(0, 0, 1)).build()

    return build


def used(twin):
    """What was taken from the battery (As)."""
    return (0.02 - twin.latest(STATE).charge) * HOUR


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_velocity_that_is_commanded_starts_the_load(cart, time_step):
    twin = cart(time_step=time_step)
    twin.advance_to(1.0)
    assert used(twin) == 0.0
    twin.publish("/cart/go", {"data": 0.5})
    twin.advance_to(4.0)
    assert used(twin) == pytest.approx(2.0 * 3.0, rel=0.01)


def test_a_commanded_motion_starts_the_load_and_a_joint_that_is_pushed_does_not():
    run = battery()
    run.fix("state", [0.0, 0.0, 1.0, 1.0])
    run.advance(0.1)
    assert run.output("battery_state").power_supply_status == 4
    run.fix("commanded_motion", [1.0])
    run.advance(0.2)
    assert run.output("battery_state").power_supply_status == 2
    run.fix("commanded_motion", [0.0])
    run.advance(0.3)
    assert run.output("battery_state").power_supply_status == 2


def test_a_joint_that_moves_to_a_position_starts_the_load(cart):
    twin = cart(kind="joint-position-controller")
    twin.advance_to(0.5)
    assert used(twin) == 0.0
    twin.publish("/cart/go", {"data": 0.5})
    twin.advance_to(1.5)
    assert used(twin) == pytest.approx(2.0, rel=0.05)


def test_messages_of_any_type_on_its_topics_start_and_end_the_load(cart):
    topics = "<power_draining_topic>/work</power_draining_topic><power_draining_topic>/go</power_draining_topic>"
    twin = cart(topics + "<stop_power_draining_topic>/rest</stop_power_draining_topic>")
    twin.publish("/work", {})
    twin.advance_to(2.0)
    assert used(twin) == pytest.approx(4.0, rel=0.02)
    twin.publish("/rest", {})
    twin.advance_to(3.0)
    before = used(twin)
    assert before == pytest.approx(4.0, rel=0.02)
    twin.publish("/cart/go", {"data": 0.0})  # of the joint's own topic, which moves nothing
    twin.advance_to(4.0)
    assert used(twin) - before == pytest.approx(2.0, rel=0.03)


def test_a_message_recharges(cart):
    twin = cart(
        "<enable_recharge>true</enable_recharge><charging_time>0.01</charging_time><initial_charge>0.01</initial_charge>"
    )
    twin.publish("/cart/battery/cell/recharge/start", {"data": True})
    twin.advance_to(5.0)
    assert 36.0 - used(twin) == pytest.approx(2.0 * 5.0, rel=0.01)


def test_a_restored_battery_goes_on_to_the_same_bits(cart):
    twin = cart("<start_draining>true</start_draining>")
    twin.advance_to(0.515)
    snapshot = twin.snapshot()
    twin.advance_to(1.0)
    end, state = twin.state_sha256(), used(twin)
    twin.restore(snapshot)
    assert used(twin) < state
    twin.advance_to(1.0)
    assert (twin.state_sha256(), used(twin)) == (end, state)


@pytest.mark.parametrize(
    ("elements", "why"),
    [
        (ELEMENTS.replace("<capacity>0.02", "<capacity>0"), "<capacity> is 0"),
        (ELEMENTS.replace("capacity>", "capacitance>"), "<capacity> is missing"),
        (ELEMENTS.replace("<voltage>12</voltage>", ""), "<voltage> is missing"),
        (ELEMENTS.replace("<battery_name>cell</battery_name>", ""), "<battery_name> is missing"),
        (
            f"{ELEMENTS}<enable_recharge>1</enable_recharge>",
            "<enable_recharge> needs a <charging_time>, which is missing",
        ),
    ],
)
def test_a_plugin_that_cannot_work_is_a_finding(cart, elements, why):
    (finding,) = [item for item in cart(elements=elements).findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(f"linear_battery_plugin (gz-sim-linearbatteryplugin-system): {why}")


def test_what_gz_sim_replaces_is_a_warning(cart):
    elements = ELEMENTS.replace("<power_load>24</power_load>", "<initial_charge>0.5</initial_charge>")
    elements = elements.replace("<smooth_current_tau>0.01", "<smooth_current_tau>0")
    twin = cart(elements=elements)
    found = [item.what for item in twin.findings if item.kind is Kind.WARNING]
    assert found == [
        "Gazebo plugin linear_battery_plugin: <initial_charge> is 0.5, and 0.02 is used: it is within the capacity",
        "Gazebo plugin linear_battery_plugin: <smooth_current_tau> is 0, and 1 is used: it has to be above zero",
        "Gazebo plugin linear_battery_plugin: <power_load> is missing: it has no load",
    ]


def test_a_bad_value_is_refused_with_its_file_and_line(cart):
    with pytest.raises(InputError) as raised:
        cart(elements=ELEMENTS.replace("<power_load>24", "<power_load>all"))
    place = "cart.sdf:7: <plugin filename='gz-sim-linearbatteryplugin-system'>: "
    assert f"{place}<power_load> is 'all', which is not a number" in str(raised.value)
