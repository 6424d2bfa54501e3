"""What an alarm looks like: which of the known faults explains the differences best.

Each fault is a function of the evidence that returns how well it fits (0 to 1), the parts that it is about, and a text.
"""

from collections.abc import Callable

import numpy as np

from drake_twin.mirror.evidence import Evidence

Fit = tuple[float, tuple[str, ...], str]
_NONE: Fit = (0.0, (), "")
_LEAST = 0.3  # what fits worse is not said
_PLANAR = ("linear.x", "linear.y", "angular.z")
_LOOSE = 0.65  # of the twin's efforts, below which wheels have little grip
_EXPLAINED = 0.4  # of the efforts that a payload has to explain
_JUMP = 10.0  # standard deviations of a step that no velocity explains
_HIT = 0.8  # s, from which on it is not a collision
MODEL_WRONG = "model_wrong"

KINDS: dict[str, Callable[[Evidence], Fit]] = {}


def fault(kind: str) -> Callable[[Callable[[Evidence], Fit]], Callable[[Evidence], Fit]]:
    """Register a function that says how well a kind of fault fits."""

    def register(fit: Callable[[Evidence], Fit]) -> Callable[[Evidence], Fit]:
        KINDS[kind] = fit
        return fit

    return register


def looks_like(evidence: Evidence) -> tuple[str, tuple[str, ...], str]:
    """Return the fault that fits best, its parts, and a text; ``model_wrong`` if none fits."""
    fits = {kind: fit(evidence) for kind, fit in KINDS.items()}
    kind = max(fits, key=lambda item: fits[item][0])
    score, parts, text = fits[kind]
    if score < _LEAST:
        return MODEL_WRONG, (), "the robot moves otherwise than its twin, as none of the known faults would have it"
    return kind, parts, text


@fault("encoder_frozen")
def _encoder_frozen(evidence: Evidence) -> Fit:
    """A number repeats itself to the last bit, which no noisy measurement does."""
    parts = tuple(dict.fromkeys(name.rpartition(".")[0] for name in evidence.frozen))
    if not parts or len(parts) == len(evidence.joints.names) > 1:
        return _NONE
    return 0.99, parts, f"the encoder of {', '.join(parts)} reports the same number again and again"


@fault("noise_risen")
def _noise_risen(evidence: Evidence) -> Fit:
    """The noise of single measurements has risen, and their mean is right."""
    parts = tuple(dict.fromkeys(name.rpartition(".")[0] or name for name in evidence.jittery))
    fits = []
    for name in evidence.jittery:
        left = evidence.deviations(name)
        if len(left) < 6:
            continue
        again = float(np.dot(left[1:], left[:-1])) / max(float(np.dot(left, left)), 1e-9)
        often = float(np.mean(np.abs(left) > 2.0))
        fits.append(min(0.95 - max(again, 0.0), 2.5 * often))
    return max(max(fits, default=0.0), 0.0), parts, f"the measurements of {', '.join(parts)} are noisier than they were"


@fault("emergency_stop")
def _emergency_stop(evidence: Evidence) -> Fit:
    """All joints stand still while the commands move them."""
    names = evidence.joints.names
    late = evidence.joints.times >= evidence.joints.times[-1] - 0.3 if len(evidence.joints.times) else np.zeros(0, bool)
    gains = [evidence.gain(j, 0.4) for j in range(len(names))]
    known = [gain for gain in gains if np.isfinite(gain)]
    still = evidence.joints.measured("velocity")[late]
    if len(known) < 2 or (len(known) < len(names) / 2 and len(known) < 3) or not len(still):
        return _NONE
    fit = 1.0 - 2.0 * max(abs(gain) for gain in known)
    return max(0.0, 0.97 * fit), (), "no joint moves, though they are commanded to: the robot is stopped, or is deaf"


@fault("joint_stuck")
def _joint_stuck(evidence: Evidence) -> Fit:
    """One joint stands still while it is commanded to move."""
    j = evidence.slow
    if j is None or not abs(gain := evidence.gain(j)) <= 0.25:
        return _NONE
    name = evidence.joints.names[j]
    return 0.95 - abs(gain), (name,), f"{name} does not move, though it is commanded to"


@fault("motor_weak")
def _motor_weak(evidence: Evidence) -> Fit:
    """One joint moves at a part of the velocity that it is commanded."""
    j = evidence.slow
    if j is None or not 0.25 <= (gain := evidence.gain(j)) <= 0.95:
        return _NONE
    name = evidence.joints.names[j]
    return 0.9, (name,), f"{name} reaches only {gain:.0%} of its commanded velocity"


@fault("friction_risen")
def _friction_risen(evidence: Evidence) -> Fit:
    """One joint needs more effort, along its motion."""
    j = evidence.alone("effort")
    if j is None or evidence.energy["effort"][j] < 0.5 * evidence.energies[j]:
        return _NONE
    along, constant = evidence.effort_pattern(j)
    if along < max(constant - 0.05, 0.1):
        return _NONE
    name = evidence.joints.names[j]
    return 0.6 + 0.3 * along, (name,), f"{name} needs more effort along its motion: it runs harder"


@fault("effort_offset")
def _effort_offset(evidence: Evidence) -> Fit:
    """The effort of one joint is off by a constant, whichever way it moves."""
    j = evidence.alone("effort")
    if j is None or evidence.energy["effort"][j] < 0.7 * evidence.energies[j]:
        return _NONE
    along, constant = evidence.effort_pattern(j)
    if along > constant or constant < 0.3:
        return _NONE
    name = evidence.joints.names[j]
    text = f"the effort of {name} is off by a constant, whichever way it moves: its measurement has shifted"
    return 0.6 + 0.3 * constant, (name,), text


@fault("encoder_offset")
def _encoder_offset(evidence: Evidence) -> Fit:
    """A position has jumped, further than its velocity allows, and the motion is as before."""
    jumps = [evidence.jump(joint) for joint in range(len(evidence.joints.names))]
    j = int(np.argmax(jumps)) if jumps else 0
    others = max((jump for joint, jump in enumerate(jumps) if joint != j), default=0.0)
    if not jumps or jumps[j] < max(_JUMP, 3 * others) or abs(evidence.gain(j) - 1.0) > 0.2:
        return _NONE
    name = evidence.joints.names[j]
    return (
        0.97,
        (name,),
        f"the position of {name} has jumped, which its velocity does not explain: its encoder has shifted",
    )


@fault("delay")
def _delay(evidence: Evidence) -> Fit:
    """All joints do what the twin's do, but later."""
    late, explained = evidence.delay()
    if late == 0.0 or (evidence.slow is not None and len(evidence.joints.names) > 1):
        return _NONE
    return 0.95 * explained, (), f"the robot does what it is told {late:.2f} s later than before"


@fault("payload_changed")
def _payload_changed(evidence: Evidence) -> Fit:
    """The efforts differ as a mass at the end of the arm would have it."""
    from drake_twin.mirror.loads import payload

    if evidence.has_base:
        return _NONE
    mass, explained = payload(evidence)
    if not explained > _EXPLAINED or np.count_nonzero(evidence.energy["effort"] > 1.0) < 2:
        return _NONE
    how = "more" if mass > 0 else "less"
    return 0.92, (), f"the arm carries {abs(mass):.2g} kg {how} than its twin"


@fault("wheel_slip")
def _wheel_slip(evidence: Evidence) -> Fit:
    """The wheels turn as they are told, with little effort, but the base does not move as they turn."""
    off, wheels = _base(evidence)
    if off < 1.0 or wheels > off:
        return _NONE
    lasts = evidence.lasts(*_PLANAR) >= _HIT
    fit = 0.8 if np.isnan(evidence.grip) and lasts else 0.9 if evidence.grip < _LOOSE else 0.5
    return fit, (), "the base does not move as its wheels turn: they slip"


@fault("carried")
def _carried(evidence: Evidence) -> Fit:
    """The base moves up, or for a while sideways, where no wheel could bring it."""
    off, wheels = _base(evidence)
    text = "the base moves where no wheel could bring it: it is carried"
    if evidence.base_energy("up") > 10.0:
        return 0.95, (), text
    sideways = evidence.base_energy("linear.y")
    if sideways < 0.5 * off or sideways < 3.0 or wheels > off or evidence.lasts("linear.y") < _HIT:
        return _NONE
    return 0.7, (), text


@fault("collision")
def _collision(evidence: Evidence) -> Fit:
    """A force from outside acts: the efforts of several joints change at once, or the base is pushed for a moment."""
    text = "a force from outside acts on the robot: it has hit something, or is held"
    off, wheels = _base(evidence)
    if off > 1.0 and wheels < off and not evidence.grip < _LOOSE:
        return 0.85, (), text
    names = evidence.joints.names
    effort = evidence.energy["effort"]
    many = np.count_nonzero(effort > max(0.3 * float(np.max(effort, initial=0.0)), 1.0))
    if len(names) < 2 or many < 2:
        return _NONE
    return 0.55, (), text


def _base(evidence: Evidence) -> tuple[float, float]:
    """Return how unusual the base moves, and how unusual the wheel turns that does so most."""
    return evidence.base_energy(*_PLANAR), float(np.max(evidence.energy["velocity"], initial=0.0))
