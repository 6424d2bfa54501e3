"""The names in `Scenario.values`, and the parameters of the plant that they amount to.

| name | value |
|---|---|
| ``friction`` | the ground's coefficient of friction; a pair of shapes has the smaller one of the two |
| ``ROBOT.payload``, ``ROBOT.LINK.payload`` | mass of a point at the origin of the root link or of a link (kg) |
| ``ROBOT.LINK.mass`` | mass of a link (kg); center and moments of inertia stay, as if the URDF's ``<mass>`` changed |
| ``ROBOT.LINK.inertia`` | factor of the moments of inertia about the link's center of mass |
| ``ROBOT.LINK.ixx``, ``.iyy``, ``.izz`` | one of these moments in the link's axes (kg·m²) |
| ``ROBOT.JOINT.damping`` | viscous damping of a joint (N·m·s/rad or N·s/m) |
| ``ROBOT.JOINT.rotor_inertia`` | inertia of its motor's rotor (kg·m²) |
| ``ROBOT.JOINT.gear_ratio`` | gear ratio of its motor |

They are set in the context of a diagram, at its start and at each reset: no value needs another build, but where the
servos are retuned. All else that a scenario holds, such as gravity, shapes and gains, does.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import fields

import numpy as np
from pydrake.geometry import Role
from pydrake.multibody.tree import RigidBody, RotationalInertia, SpatialInertia

from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.diagram.contact_roles import ROUGH, towards
from drake_twin.diagram.lumped_masses import gave_its_mass
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.scenario import CENIC, DISCRETE, GROUND_FRICTION, Scenario, ScenarioError

_MOMENTS = ("ixx", "iyy", "izz")
LINK_VALUES = ("mass", "inertia", *_MOMENTS, "payload")
JOINT_VALUES = ("damping", "rotor_inertia", "gear_ratio")
_POSITIVE = ("mass", "inertia", *_MOMENTS, "gear_ratio")

# The fields of a scenario that a built twin takes at its start; the others need another build, and so do the values of
# robots whose servos are retuned.
SET_AT_START = ("values", "seed", "pushes")

_Parameters = dict[str, list[float]]


def needs_build(old: Scenario, new: Scenario, plans: Sequence[RobotPlan]) -> bool:
    """Return whether a scenario needs another diagram than the one that was built for another scenario.

    Args:
        old: The scenario that was built.
        new: The other scenario.
        plans: The robots as built.
    """
    if (GROUND_FRICTION in old.values) != (GROUND_FRICTION in new.values):
        return True  # the ground's shapes are others where its friction may change
    if (old.retune or new.retune) and _of_robots(old.values) != _of_robots(new.values):
        return True  # the servos' gains are others
    may_have_noise = old.world.file is not None or any(plan.description.sensors or plan.sensors for plan in plans)
    if old.seed != new.seed and may_have_noise:
        return True
    others = (item.name for item in fields(Scenario) if item.name not in SET_AT_START)
    return any(getattr(old, name) != getattr(new, name) for name in others)  # `replace` would check all values again


def _of_robots(values: Mapping[str, float]) -> dict[str, float]:
    return {name: value for name, value in values.items() if name != GROUND_FRICTION}


def varied_parameters(built: TwinDiagram, values: Mapping[str, float]) -> _Parameters:
    """Return the parameters that values amount to, as `drake_twin.twin.plant_parameters.PlantParameters` names them.

    Args:
        built: The diagram.
        values: Name → value, as in `Scenario`.

    Raises:
        ScenarioError: If a name is unknown, or a value is not physical.
    """
    plans = {plan.name: plan for plan in built.plans}
    found: _Parameters = {}
    links: dict[tuple[str, str], dict[str, float]] = {}
    dampings: dict[tuple[str, str], dict[str, float]] = {}
    motors: dict[tuple[str, str], dict[str, float]] = {}
    for name, value in values.items():
        if name == GROUND_FRICTION:
            _check(name, value)
            found |= dict(_ground_friction(built, value))
            continue
        plan, middle, last = _parts(name, plans)
        _check(name, value)
        if last in LINK_VALUES:
            given = links.setdefault((plan.name, _link(name, plan, middle)), {})
        elif last == "damping":
            given = dampings.setdefault((plan.name, _joint(name, plan, middle)), {})
        else:
            given = motors.setdefault((plan.name, _motor(name, plan, middle)), {})
        if last in given:
            raise ScenarioError(("values", name), f"the {last} of {middle or plan.name} is given twice")
        given[last] = value
    for (robot, link), given in links.items():
        body = _body(built, plans[robot], link)
        _check_lumped(built, plans[robot], body, given, link)
        found[f"inertia of {robot}::{body.name()}"] = _inertia(body, given, f"{robot}.{link}")
    for (robot, joint_name), given in dampings.items():
        joint = built.plant.GetJointByName(joint_name, built.robots[robot].instance)
        found[f"damping of {robot}::{joint_name}"] = [given["damping"]] * joint.num_velocities()
    for (robot, joint_name), given in motors.items():
        motor = built.plant.GetJointActuatorByName(joint_name, built.robots[robot].instance)
        as_built = {"rotor_inertia": motor.default_rotor_inertia(), "gear_ratio": motor.default_gear_ratio()}
        found[f"motor {robot}::{joint_name}"] = list((as_built | given).values())
    return found


def _parts(name: str, plans: Mapping[str, RobotPlan]) -> tuple[RobotPlan, str, str]:
    """Return the robot, the link or joint, and the property of a value's name."""
    robot, _, rest = name.partition(".")
    middle, _, last = rest.rpartition(".")
    if robot not in plans:
        valid = [GROUND_FRICTION, *(f"{known}.…" for known in plans)]
        raise ScenarioError(("values", name), f"unknown value {name!r}", value=robot, valid=valid)
    if last not in (*LINK_VALUES, *JOINT_VALUES):
        valid = [*(f"{robot}.LINK.{item}" for item in LINK_VALUES), *(f"{robot}.JOINT.{item}" for item in JOINT_VALUES)]
        raise ScenarioError(("values", name), f"unknown value {name!r}", value=name, valid=valid)
    return plans[robot], middle, last


def _check(name: str, value: float) -> None:
    last = name.rpartition(".")[2]
    if not np.isfinite(value) or not (value > 0 if last in _POSITIVE else value >= 0):
        what = "above zero" if last in _POSITIVE else "zero or above"
        raise ScenarioError(("values", name), f"{name} is {value:g}: it must be {what}")


def _link(name: str, plan: RobotPlan, link: str) -> str:
    if not link and name == f"{plan.name}.payload":
        return plan.description.root_link
    return _known(name, plan, link, "link", plan.description.links)


def _joint(name: str, plan: RobotPlan, joint: str) -> str:
    return _known(name, plan, joint, "movable joint", [item.name for item in plan.description.movable_joints])


def _motor(name: str, plan: RobotPlan, joint: str) -> str:
    return _known(name, plan, joint, "driven joint", [item.name for item in plan.description.actuated_joints])


def _known(name: str, plan: RobotPlan, part: str, kind: str, valid: Collection[str]) -> str:
    """Return the full name of a link or joint, which may be given without a prefix of the robot's name."""
    for full in (part, f"{plan.name}_{part}"):
        if full in valid:
            return full
    raise ScenarioError(("values", name), f"robot {plan.name!r} has no {kind} {part!r}", value=part, valid=valid)


def _body(built: TwinDiagram, plan: RobotPlan, link: str) -> RigidBody:
    instance, own = built.robots[plan.name].instance, drake_link_name(link)
    if not built.plant.HasBodyNamed(own, instance):
        raise ScenarioError(("values", f"{plan.name}.{link}"), f"the link {link!r} is the world itself")
    return built.plant.GetBodyByName(own, instance)


def _check_lumped(built: TwinDiagram, plan: RobotPlan, body: RigidBody, given: Mapping[str, float], link: str) -> None:
    """Raise for a link whose inertia belongs to what it is fixed to; a payload is added to it."""
    if built.engine != CENIC or plan.model.drake_format != "urdf" or given.keys() == {"payload"}:
        return
    if body.default_mass() == 0.0 and gave_its_mass(plan.model.drake_text, body.name()):
        name = f"{plan.name}.{link}"
        what = f"the engine {CENIC} counts the mass of the light link {link!r} as that of the link that it is fixed to"
        raise ScenarioError(("values", name), f"{what}: vary that one, or use the engine {DISCRETE}", value=name)


def _inertia(body: RigidBody, given: Mapping[str, float], name: str) -> list[float]:
    """Return mass, center of mass, unit moments and products of a link about its origin."""
    nominal = body.default_spatial_inertia()
    mass, center = nominal.get_mass(), nominal.get_com()
    if not given.get("mass", mass) > 0:
        if given.keys() != {"payload"}:
            raise ScenarioError(("values", name), f"{name} has no mass in its file, so that it needs one here, too")
        return [given["payload"], *np.zeros(9).tolist()]  # a point at the origin
    central = nominal.Shift(center).CalcRotationalInertia() if mass > 0 else RotationalInertia(0.0, 0.0, 0.0)
    moments = [*map(float, central.get_moments())]
    products = [*map(float, central.get_products())]
    factor = given.get("inertia", 1.0)
    moments, products = [factor * item for item in moments], [factor * item for item in products]
    moments = [given.get(key, moment) for key, moment in zip(_MOMENTS, moments, strict=True)]
    principal = np.linalg.eigvalsh(_matrix(moments, products))
    if principal[0] < 0 or principal[0] + principal[1] < principal[2] * (1 - 1e-12):
        what = "the largest principal moment must not exceed the sum of the others"
        found = ", ".join(f"{item:g}" for item in principal)
        raise ScenarioError(("values", name), f"{name} would have the moments of inertia {found} kg·m²: {what}")
    about_center = RotationalInertia(*moments, *products)
    inertia = SpatialInertia.MakeFromCentralInertia(given.get("mass", mass), center, about_center)
    unit, payload = inertia.get_unit_inertia(), given.get("payload", 0.0)
    numbers = np.array([*inertia.get_com(), *unit.get_moments(), *unit.get_products()])
    total = inertia.get_mass() + payload  # a point at the origin has no moments about it
    if payload > 0:
        numbers *= inertia.get_mass() / total
    return [float(total), *numbers.tolist()]


def _matrix(moments: Sequence[float], products: Sequence[float]) -> np.ndarray:
    (xx, yy, zz), (xy, xz, yz) = moments, products
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _ground_friction(built: TwinDiagram, friction: float) -> Iterator[tuple[str, list[float]]]:
    """Yield the friction of each of the ground's shapes, so that a pair has the smaller one of the two."""
    inspector = built.scene_graph.model_inspector()
    ground = tuple(shape.name for shape in built.shapes if (shape.model, shape.friction) == ("", ROUGH))
    if not ground:
        raise ScenarioError(("values", GROUND_FRICTION), "the twin was built without a friction to vary, or a ground")
    for geometry in inspector.GetAllGeometryIds(Role.kProximity):
        name = inspector.GetName(geometry)
        if name.partition("|")[0] in ground:
            body = built.plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
            model = built.plant.GetModelInstanceName(body.model_instance())
            own = inspector.GetProximityProperties(geometry).GetProperty("material", "coulomb_friction")
            acts = towards(own.dynamic_friction(), friction)
            yield f"shape {model}::{body.name()} {name} material/coulomb_friction", [acts, acts]
