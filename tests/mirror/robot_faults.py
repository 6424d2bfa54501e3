"""The faults of the robots that tests let a mirror hear: what each of them does, and how large it is.

| kind | what is done, from its beginning on | rover | arm |
|---|---|---|---|
| ``friction_risen`` | the dry friction of one joint rises by | 1.5 N·m | 1.2, 1.2, 0.8, 0.2 N·m of joints 1 to 4 |
| ``joint_stuck`` | one joint stands still, whatever its motor does | | |
| ``encoder_offset`` | one joint's position is reported with an offset of | ±0.25 rad | ±0.06 rad |
| ``encoder_frozen`` | one joint's position and velocity are reported as they were last, to the last bit | | |
| ``noise_risen`` | the noise of positions and velocities of one joint (or, every other seed, of all) times | 5 | 5 |
| ``delay`` | the robot does what it is told later than before by | 0.15 s | 0.15 s |
| ``motor_weak`` | one joint is driven at this part of its commanded velocity | 0.6 | 0.6 |
| ``collision`` | a level force on the chassis for 0.4 s, or one on the claw for 0.6 s across the arm | 160 N | 25 N |
| ``emergency_stop`` | all joints brake and stand still; commands are ignored | | |
| ``connection_lost`` | none of the robot's own messages comes any more; the commands are still heard | | |
| ``payload_changed`` | the claw carries more by | | 0.3 kg |
| ``effort_offset`` | the effort of one joint is reported with an offset of | | ±0.4, 1.2, 0.8, 0.15 N·m |
| ``wheel_slip`` | the ground becomes slippery: its coefficient of friction (before: 0.75) is | 0.08 | |
| ``carried`` | it is lifted by 0.15 m, carried to its left or right and set down, within 2.5 s, by | 0.7 m | |

Joint, direction and sign are random, and follow from the seed.
"""

from dataclasses import dataclass

import numpy as np

EVERY_ROBOT = (
    "friction_risen",
    "joint_stuck",
    "encoder_offset",
    "encoder_frozen",
    "noise_risen",
    "delay",
    "motor_weak",
    "collision",
    "emergency_stop",
    "connection_lost",
)
FAULTS = {"rover": (*EVERY_ROBOT, "wheel_slip", "carried"), "arm": (*EVERY_ROBOT, "payload_changed", "effort_offset")}

# A number for any joint, or one for each commanded joint; 1 of a kind that has no size.
SIZES: dict[str, dict[str, float | tuple[float, ...]]] = {
    "rover": {
        "friction_risen": 1.5,
        "encoder_offset": 0.25,
        "noise_risen": 5.0,
        "delay": 0.15,
        "motor_weak": 0.6,
        "collision": 160.0,
        "wheel_slip": 0.08,
        "carried": 0.7,
    },
    "arm": {
        "friction_risen": (1.2, 1.2, 0.8, 0.2),
        "encoder_offset": 0.06,
        "noise_risen": 5.0,
        "delay": 0.15,
        "motor_weak": 0.6,
        "collision": 25.0,
        "payload_changed": 0.3,
        "effort_offset": (0.4, 1.2, 0.8, 0.15),
    },
}
DURATIONS = {("rover", "collision"): 0.4, ("arm", "collision"): 0.6, ("rover", "carried"): 2.5}  # s
OF_ONE_JOINT = ("friction_risen", "joint_stuck", "encoder_offset", "encoder_frozen", "motor_weak", "effort_offset")


@dataclass(frozen=True)
class Fault:
    """A fault of one run.

    Attributes:
        kind: One of `FAULTS`.
        at: When it begins (s of true time).
        until: When it is over (s); infinity for one that stays.
        size: Its size, as in the table; with its sign where it has one.
        joint: The index of the joint among the commanded ones; None if it is about none or all of them.
        direction: The direction of a collision (rad), to whose left or right (±1) a rover is carried.
    """

    kind: str
    at: float
    until: float
    size: float
    joint: int | None
    direction: float

    def acts(self, *kinds: str, time: float) -> bool:
        """Return whether it is of one of these kinds and acts at a time (s)."""
        return self.kind in kinds and self.at <= time < self.until


def fault_of(robot: str, kind: str | None, at: float, size: float | None, seed: int, joints: int) -> Fault | None:
    """Return the fault of a run; None for a healthy one.

    Args:
        robot: ``rover`` or ``arm``.
        kind: The kind; None for a healthy run.
        at: When it begins (s).
        size: Its size; that of the table by default.
        seed: Gives the joint, direction and sign.
        joints: The number of commanded joints.

    Raises:
        ValueError: If such a robot does not have such a fault.
    """
    if kind is None:
        return None
    if kind not in FAULTS[robot]:
        raise ValueError(f"{kind!r} is no fault of the {robot}: {', '.join(FAULTS[robot])}")
    generator = np.random.default_rng([seed, 1])
    joint: int | None = int(generator.integers(joints))
    sign, direction, is_of_all = (
        generator.choice((-1.0, 1.0)),
        generator.uniform(-np.pi, np.pi),
        generator.random() < 0.5,
    )
    if kind not in OF_ONE_JOINT and (kind != "noise_risen" or is_of_all):
        joint = None
    if size is None:
        usual = SIZES[robot].get(kind, 1.0)
        size = usual[joint or 0] if isinstance(usual, tuple) else usual
    size *= sign if kind in ("encoder_offset", "effort_offset") else 1.0
    until = at + DURATIONS.get((robot, kind), np.inf)
    return Fault(kind, at, until, float(size), joint, sign if kind == "carried" else direction)
