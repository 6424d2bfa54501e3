"""Scenario → Drake diagram: the plant and its robots, one sub-diagram per robot, clock, tf and viewer."""

from pydrake.multibody.plant import MultibodyPlant

from drake_twin.requirements import check_drake

if not hasattr(MultibodyPlant, "RemoveAllJointActuatorEffortLimits"):  # it is new in Drake 1.51
    check_drake()
