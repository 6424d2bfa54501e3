"""The result of a run as plain data, which ``--summary FILE`` writes for the user's CI."""

from typing import Any

from drake_twin.allocator import description
from drake_twin.errors import RunError
from drake_twin.twin.twin import Twin
from drake_twin.versions import SUMMARY, head


def summary(twin: Twin, simulated: float, wall_time: float, failure: RunError | None = None) -> dict[str, Any]:
    """Return the result of a run as plain data for JSON.

    - ``format``, ``version`` of this form, ``written_by``: the versions for which the hash is promised
    - ``sim_time``, ``wall_time`` (s), ``real_time_factor`` (of this run), ``time_step`` (s), ``steps``
    - ``robots``: name → ``joints`` (names of the movable joints), ``positions`` (rad or m), ``velocities``,
      ``efforts`` (that actuators apply, N·m or N; None after a failure, for they are those of the next step),
      ``base_pose`` [x, y, z, qw, qx, qy, qz] of the root link
    - ``allocator``: of memory: the tunable of the C library that the program has set, else ``system``
    - ``seed`` and ``sensor_noise``: what the noise of sensors is drawn from, and whether there is any
    - ``topics``: name → ROS message type
    - ``warnings``, ``not_started``: lists of sentences
    - ``findings``: what of the files is not used as it is: ``kind`` (mended, warning, ignored, not started,
      failed or window), ``what``, ``robot``, ``file``, ``lines``, ``rule``, ``weight`` (lost, moves or looks)
    - ``failure``: the error that ended the run, else None; all other entries are those of the last good state then
    - ``state_sha256``: equal for two runs that ended in the same state to the last bit

    Args:
        twin: The twin at its last moment.
        simulated: The time that the run has simulated (s).
        wall_time: The duration of the run (s).
        failure: The error that ended the run, if there was one.
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
        **head(SUMMARY),
        "sim_time": twin.time,
        "wall_time": wall_time,
        "real_time_factor": simulated / wall_time if wall_time > 0 else 0.0,
        "time_step": twin.scenario.time_step,
        "steps": twin.clock.step_count,
        "allocator": description(),
        "seed": twin.scenario.seed,
        "sensor_noise": twin.scenario.sensor_noise,
        "robots": robots,
        "topics": twin.graph.topics(),
        "warnings": list(twin.findings.warnings),
        "not_started": list(twin.findings.not_started),
        "findings": [finding.as_plain() for finding in twin.findings],
        "failure": None if failure is None else str(failure),
        "state_sha256": twin.state_sha256(),
    }
