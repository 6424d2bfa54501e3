"""The system of gz-sim that is a model's battery, as a controller that commands nothing."""

from typing import Any

from drake_twin.description.gazebo_drive import (
    LINEAR_BATTERY,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)
from drake_twin.description.triggers import ANY_TYPE, Trigger, TriggeredMessage

_RATE = 50.0  # Hz
_NUMBERS = ("voltage", "open_circuit_voltage_constant_coef", "open_circuit_voltage_linear_coef", "resistance")


@gazebo_plugin("gz-sim-linearbatteryplugin-system")
def linear_battery_plugin_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-linearbatteryplugin-system`` to the twin's own controller of this kind."""
    name, capacity = plugin.text("battery_name", ""), plugin.number("capacity", 0.0)
    warnings = []
    if capacity <= 0.0:
        raise CannotWorkError(f"<capacity> is {capacity:g}" if plugin.has("capacity") else "<capacity> is missing")
    if not name or not plugin.has("voltage"):
        raise CannotWorkError(f"<{'voltage' if name else 'battery_name'}> is missing")
    charge = plugin.number("initial_charge", capacity)
    if not 0.0 <= charge <= capacity:  # as gz-sim
        given, charge = charge, min(max(charge, 0.0), capacity)
        warnings.append(f"<initial_charge> is {given:g}, and {charge:g} is used: it is within the capacity")
    tau = plugin.number("smooth_current_tau", 1.0)
    if tau <= 0.0:  # as gz-sim
        warnings.append(f"<smooth_current_tau> is {tau:g}, and 1 is used: it has to be above zero")
        tau = 1.0
    charging_time = 0.0
    if plugin.flag("enable_recharge", False):
        charging_time = plugin.number("charging_time", 0.0)
        if charging_time <= 0.0:
            has = f"is {charging_time:g}" if plugin.has("charging_time") else "is missing"
            raise CannotWorkError(f"<enable_recharge> needs a <charging_time>, which {has}")
    plugin.has("charging_time")
    plugin.skip("start_on_motion", "true", "1")
    plugin.has("recharge_by_topic")  # always so here
    if not plugin.has("power_load"):
        warnings.append("<power_load> is missing: it has no load")
    parameters: dict[str, Any] = {
        "battery_name": name,
        **{tag: plugin.number(tag, 0.0) for tag in _NUMBERS},
        "capacity": capacity,
        "initial_charge": charge,
        "smooth_current_tau": tau,
        "power_load": plugin.number("power_load", 0.0),
        "start_draining": plugin.flag("start_draining", False),
        "charging_time": charging_time,
        "fix_issue_225": plugin.flag("fix_issue_225", False),
        "invert_current_sign": plugin.flag("invert_current_sign", False),
        "update_rate": _RATE,
    }
    topics = {"battery_state": f"battery/{name}/state", "draining": f"battery/{name}/draining"}
    if charging_time:
        topics |= {f"recharge_{what}": f"battery/{name}/recharge/{what}" for what in ("start", "stop")}
    return plugin.drive(
        LINEAR_BATTERY,
        parameters,
        topics=topics,
        gz_topics={own: f"/model/{{model}}/{topic}" for own, topic in topics.items()},
        triggers=tuple(_switches(plugin, f"/model/{{model}}/{topics['draining']}")),
        warnings=tuple(warnings),
    )


def _switches(plugin: DrivePlugin, topic: str) -> list[Trigger]:
    """Return what tells the battery of messages of any type that start and end its load."""
    tags = {"power_draining_topic": True, "stop_power_draining_topic": False}
    return [
        Trigger(
            name=plugin.name,
            topic=f"/{heard.strip('/')}",
            type=ANY_TYPE,
            messages=(TriggeredMessage(topic, "std_msgs/msg/Bool", {"data": is_on}),),
            place=plugin.plugin.place,
        )
        for tag, is_on in tags.items()
        for heard in plugin.texts(tag)
    ]
