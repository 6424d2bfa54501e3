"""The systems of gz-sim for vehicles in water and airships, as controllers that exert forces."""

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from drake_twin.description.added_mass import IMPLIED, added_mass_of, fluid_added_mass
from drake_twin.description.gazebo_drive import (
    BUOYANCY_ENGINE,
    EACH_STEP,
    HYDRODYNAMICS,
    LIGHTER_THAN_AIR,
    THRUSTER,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    Servo,
    gazebo_plugin,
)
from drake_twin.description.sname import coefficient_name

_LARGEST = 1000.0  # N or rad/s, of a command


@gazebo_plugin("gz-sim-hydrodynamics-system")
def hydrodynamics_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-hydrodynamics-system``: damping, added mass and current of one link."""
    link = plugin.link()
    written = {tag: plugin.number(tag, 0.0) for tag in plugin.plugin.elements if coefficient_name(tag)}
    coefficients = {_renamed(tag, written, plugin.plugin.filename): value for tag, value in written.items()}
    parameters: dict[str, object] = {
        "link_name": link,
        "coefficients": coefficients,
        "disable_added_mass": plugin.flag("disable_added_mass", False),
        "disable_coriolis": plugin.flag("disable_coriolis", False),
        "default_current": list(plugin.vector("default_current")),
    }
    if (added := fluid_added_mass(plugin.description.text, link, plugin)) is not None:
        parameters["fluid_added_mass"] = added.ravel().tolist()
    plugin.has("water_density")  # which gz-sim does not use
    space = plugin.text("namespace", "").strip("/")
    topic = f"/model/{space}/ocean_current" if space else "/ocean_current"
    return plugin.drive(
        HYDRODYNAMICS,
        parameters,
        topics={"ocean_current": "ocean_current" if space else "/ocean_current"},
        gz_topics={"ocean_current": topic},
        warnings=(
            *(_wrong_way(tag, value) for tag, value in coefficients.items() if value > 0.0 and _brakes(tag)),
            *(_one_way(tag, value) for tag, value in coefficients.items() if value and _is_square(tag)),
            *(() if parameters["disable_coriolis"] else _turning(coefficients)),
        ),
    )


@gazebo_plugin(IMPLIED)
def fluid_added_mass_of_link(plugin: DrivePlugin) -> GazeboDrive:
    """Convert SDF's ``<fluid_added_mass>`` of a link without a plugin about it, as Gazebo's engine has it."""
    values = {tag: plugin.text(tag, "") for tag in plugin.plugin.elements}
    added = added_mass_of(values, plugin)
    return plugin.drive(HYDRODYNAMICS, {"link_name": values["link_name"], "fluid_added_mass": added.ravel().tolist()})


def _renamed(tag: str, written: Collection[str], library: str) -> str:
    """Return the name that a coefficient has today: Gazebo Fortress, Ignition as yet, had xUU for xUabsU.

    A file with ignition's name of the library is written for Fortress, unless it has names that came after it.
    """
    is_of_fortress = "ignition-gazebo" in library and not any("abs" in other for other in written)
    return f"{tag[:-1]}abs{tag[-1]}" if is_of_fortress and _is_square(tag) else tag


def _turning(coefficients: Mapping[str, float]) -> Iterator[str]:
    """Yield the added mass across a hull that turns it away from its course: Munk's moment."""
    along = -coefficients.get("xDotU", 0.0)
    tag = max(("yDotV", "zDotW"), key=lambda name: -coefficients.get(name, 0.0))
    if (across := -coefficients.get(tag, 0.0)) > along:
        turns = "its Coriolis forces turn a hull without fins across its course, as in water"
        yield f"<{tag}> of {-across:g} is more than <xDotU>: {turns}; gz-sim has them with the opposite sign"


def _is_square(tag: str) -> bool:
    """Tell whether a coefficient is of the square of a velocity, whose force has one sign for both directions."""
    axes = coefficient_name(tag)
    return axes is not None and not axes.is_absolute and axes.other == axes.velocity


def _one_way(tag: str, value: float) -> str:
    size = f"<{tag[:-1]}abs{tag[-1]}>"
    return f"<{tag}> is {value:g}, a force of one sign for both directions, as in gz-sim: {size} has two"


def _brakes(tag: str) -> bool:
    """Tell whether a coefficient acts along the axis of its velocity, against that or its change."""
    axes = coefficient_name(tag)
    if axes is None or axes.force != axes.velocity:
        return False
    return axes.other is None or (axes.is_absolute and axes.other == axes.force)


def _wrong_way(tag: str, value: float) -> str:
    is_mass = "Dot" in tag
    does, what = ("takes mass from the link", "added mass") if is_mass else ("drives the link", "damping")
    return f"<{tag}> is {value:g} and {does}, as in gz-sim: {what} is negative in SNAME's notation"


# Element → gz-sim's default.
_NUMBERS = {
    "alpha_1": 1.0,
    "alpha_2": 0.0,
    "wake_fraction": 0.2,
    "fluid_density": 1000.0,
    "propeller_diameter": 0.02,
    "deadband": 0.0,
}


@gazebo_plugin("gz-sim-thruster-system")
def thruster_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-thruster-system``: a propeller, its thrust and what turns it."""
    (joint,) = plugin.joints("joint_name")[:1]
    parameters: dict[str, Any] = {tag: plugin.number(tag, default) for tag, default in _NUMBERS.items()}
    for tag in ("fluid_density", "propeller_diameter"):
        if parameters[tag] <= 0.0:
            raise plugin.error(f"<{tag}> is {parameters[tag]:g}, and has to be above zero")
    is_constant = plugin.has("thrust_coefficient")
    tag = "thrust_coefficient" if is_constant else "alpha_1"
    parameters[tag] = plugin.number(tag, 1.0)
    if parameters[tag] == 0.0:
        raise plugin.error(f"<{tag}> is 0, so that nothing is thrust")
    largest, smallest = plugin.number("max_thrust_cmd", _LARGEST), plugin.number("min_thrust_cmd", -_LARGEST)
    warnings = []
    if largest < smallest:
        what = f"<max_thrust_cmd> is less than <min_thrust_cmd>: commands are within {_LARGEST:g}, as in gz-sim"
        largest, smallest, warnings = _LARGEST, -_LARGEST, [what]
    if is_constant and (plugin.has("alpha_1") or plugin.has("alpha_2")):
        warnings.append("<alpha_1> and <alpha_2> change nothing beside <thrust_coefficient>, as in gz-sim")
    of_speed, is_direct = plugin.flag("use_angvel_cmd", False), plugin.flag("velocity_control", False)
    parameters |= {
        "joint_name": joint,
        "max_thrust_cmd": largest,
        "min_thrust_cmd": smallest,
        "use_angvel_cmd": of_speed,
        "velocity_control": is_direct,
        "update_rate": EACH_STEP,
    }
    gain = plugin.number("p_gain", 0.1)
    if gain < 0.0:
        raise CannotWorkError(f"<p_gain> is {gain:g}: the propeller would run away")
    for unused in ("i_gain", "d_gain"):
        plugin.has(unused)  # which gz-sim does not use
    space = plugin.text("namespace", "{model}").strip("/")
    below = plugin.text("topic", "").strip("/")
    gz = f"/{space}/{below}" if below else f"/model/{space}/joint/{joint}"
    ros = below or f"joint/{joint}"
    command = "cmd_vel" if of_speed else "cmd_thrust"
    names = {command: "" if below else f"/{command}", "enable_deadband": "/enable_deadband"}
    names |= {"force": "/force"} if of_speed else {"ang_vel": "/ang_vel"}
    return plugin.drive(
        THRUSTER,
        parameters,
        topics={own: ros + name for own, name in names.items()},
        gz_topics={own: gz + name for own, name in names.items()},
        interfaces=((joint, "velocity"),),
        servos={(joint, "velocity"): Servo() if is_direct else Servo(gain)},
        warnings=tuple(warnings),
    )


# Element → gz-sim's default.
_OF_BLADDER = {
    "min_volume": 3e-5,
    "max_volume": 9.9e-4,
    "neutral_volume": 3e-4,
    "max_inflation_rate": 3e-6,
    "fluid_density": 1000.0,
}
_FIRST_VOLUME = 3e-5  # m³, which gz-sim approaches from the smallest one where the file has no other


@gazebo_plugin("gz-sim-buoyancy-engine-system")
def buoyancy_engine_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-buoyancy-engine-system``: a bladder to rise and dive with."""
    link = plugin.link()
    parameters: dict[str, Any] = {tag: plugin.number(tag, default) for tag, default in _OF_BLADDER.items()}
    for tag in ("max_inflation_rate", "fluid_density"):
        if parameters[tag] < 0.0:
            raise plugin.error(f"<{tag}> is {parameters[tag]:g}, and has to be zero or more")
    if parameters["max_volume"] < parameters["min_volume"]:
        raise plugin.error("<max_volume> is less than <min_volume>")
    has_own = plugin.has("default_volume")
    first = plugin.number("default_volume", parameters["min_volume"])
    parameters |= {"link_name": link, "default_volume": first, "first_target": first if has_own else _FIRST_VOLUME}
    if plugin.has("surface"):
        parameters["surface"] = plugin.number("surface", 0.0)
    space = plugin.text("namespace", "").strip("/")
    gz = f"/model/{space}/buoyancy_engine" if space else "/buoyancy_engine"
    ros = "buoyancy_engine" if space else "/buoyancy_engine"
    return plugin.drive(
        BUOYANCY_ENGINE,
        parameters,
        topics={"buoyancy_engine": ros, "current_volume": f"{ros}/current_volume"},
        gz_topics={"buoyancy_engine": gz, "current_volume": f"{gz}/current_volume"},
    )


_OF_HULL = (
    *("force_inviscid_coeff", "force_viscous_coeff", "moment_inviscid_coeff", "moment_viscous_coeff"),
    *("eps_v", "axial_drag_coeff"),
)


@gazebo_plugin("gz-sim-lighter_than_air_dynamics-system", "gz-sim-lighter-than-air-dynamics-system")
def lighter_than_air_dynamics_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-lighter_than_air_dynamics-system``: the air about the hull of an airship."""
    link = plugin.link()
    for tag in _OF_HULL:
        if not plugin.has(tag):
            raise CannotWorkError(f"<{tag}> is missing")
    density = plugin.number("air_density", 1.225)
    if density < 0.0:
        raise plugin.error(f"<air_density> is {density:g}, and has to be zero or more")
    added = fluid_added_mass(plugin.description.text, link, plugin)
    if added is None:
        raise CannotWorkError(f"link {link!r} has no <fluid_added_mass>")
    parameters: dict[str, Any] = {tag: plugin.number(tag, 0.0) for tag in _OF_HULL}
    parameters |= {"link_name": link, "air_density": density, "fluid_added_mass": added.ravel().tolist()}
    return plugin.drive(LIGHTER_THAN_AIR, parameters)
