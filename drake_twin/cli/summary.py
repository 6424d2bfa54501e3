"""A run's result as plain data, as ``--summary FILE`` writes it for people's own CI to read."""

from typing import Any

from drake_twin.errors import RunError
from drake_twin.twin.twin import Twin


def summary(twin: Twin, wall_time: float, failure: RunError | None = None) -> dict[str, Any]:
    """What a run came to, as JSON has it.

    - ``sim_time``, ``wall_time`` (s), ``real_time_factor`` (sim over wall time), ``time_step`` (s), ``steps``
    - ``robots``: name → ``joints`` (names of the movable joints), ``positions`` (rad or m), ``velocities``,
      ``efforts`` (that actuators apply, N·m or N; None after a failure, as they are those of the step to come),
      ``base_pose`` [x, y, z, qw, qx, qy, qz] of the root link
    - ``topics``: name → ROS message type
    - ``warnings``, ``not_started``: lists of sentences
    - ``findings``: what became of what the files say, where it is not simply used: ``kind`` (mended, warning, ignored,
      not started or window), ``what``, ``robot``, ``file``, ``lines``, ``rule``
    - ``failure``: why the run ended before its time, after the last good state, which all of this is about; else None
    - ``state_sha256``: equal for two runs that ended in the same state to the last bit

    Args:
        twin: the twin at its last moment.
        wall_time: how long it ran (s).
        failure: what ended the run.
    """
    robots = {}
    for name in twin.robots:
        state = twin.robot_state(name, with_efforts=failure is None)
        robots[name] = {
            "joints": list(state.joints),
            "positions": list(state.positions),
            "velocities": list(state.velocities),
            "efforts": list(state.efforts) if failure is None else None,
            "base_pose": list(state.base_pose),
        }
    return {
        "sim_time": twin.time,
        "wall_time": wall_time,
        "real_time_factor": twin.time / wall_time if wall_time > 0 else 0.0,
        "time_step": twin.scenario.time_step,
        "steps": twin.step_count,
        "robots": robots,
        "topics": twin.topics(),
        "warnings": list(twin.warnings),
        "not_started": list(twin.not_started),
        "findings": [finding.as_plain() for finding in twin.findings],
        "failure": None if failure is None else str(failure),
        "state_sha256": twin.state_sha256(),
    }
