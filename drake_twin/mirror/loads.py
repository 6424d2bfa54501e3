"""What a mass at the end of an arm would change in its efforts."""

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from drake_twin.mirror.evidence import Evidence

_MOST = 40  # moments that are looked at


def payload(evidence: Evidence) -> tuple[float, float]:
    """Return the mass (kg) at the arm's last link that explains the efforts best, and the part of them it explains.

    The mass is NaN where efforts are not measured, or the arm has no end.
    """
    twin, joints = evidence.twin, evidence.joints
    plan = next(plan for plan in twin.built.plans if plan.name == evidence.robot)
    plant, parts = twin.plant, twin.built.robots[evidence.robot]
    left = joints.left("effort")
    if not len(joints.times) or np.isnan(left).all():
        return float("nan"), 0.0
    movable = {joint.child: joint for joint in plan.description.movable_joints}
    above = {joint.child: joint.parent for joint in plan.description.joints}

    def depth(link: str) -> int:
        count = 0
        while link in above:
            count += link in movable
            link = above[link]
        return count

    from drake_twin.description.drake_urdf import drake_link_name

    ends = [link for link in movable if movable[link].mimic is None]
    end = max(ends, key=depth)
    body = plant.GetBodyByName(drake_link_name(end), parts.instance)
    context = plant.CreateDefaultContext()
    q = plant.GetPositions(plant.GetMyContextFromRoot(twin.context), parts.instance)
    every = max(1, len(joints.times) // _MOST)
    rows, values, scales = [], [], []
    deviations = joints.deviations("effort")
    positions = joints.measured("position")
    columns = [parts.layout.velocities[name] for name in joints.names]
    offset = plant.num_positions(parts.instance)
    for index in range(0, len(joints.times), every):
        for name, at in zip(joints.names, positions[index], strict=True):
            if np.isfinite(at):
                q[parts.layout.positions[name]] = at
        plant.SetPositions(context, parts.instance, q)
        center = body.default_com() if hasattr(body, "default_com") else np.zeros(3)
        J = plant.CalcJacobianTranslationalVelocity(
            context, JacobianWrtVariable.kV, body.body_frame(), center, plant.world_frame(), plant.world_frame()
        )
        own = plant.GetVelocitiesFromArray(parts.instance, J[2])
        lift = 9.81 * own[[column - offset for column in columns]]  # N·m that hold one kilogram up
        rows.append(lift)
        values.append(left[index])
        scales.append(np.abs(left[index]) / np.maximum(np.abs(deviations[index]), 1e-3))
    A, b = np.concatenate(rows), np.concatenate(values)
    noise = np.concatenate(scales)
    ok = np.isfinite(b) & (noise > 0)
    if not np.any(ok):
        return float("nan"), 0.0
    A, b = A[ok] / noise[ok], b[ok] / noise[ok]
    if not np.dot(A, A) > 1e-9:
        return float("nan"), 0.0
    mass = float(np.dot(A, b) / np.dot(A, A))
    return mass, float(1.0 - np.sum((b - mass * A) ** 2) / np.sum(b**2))
