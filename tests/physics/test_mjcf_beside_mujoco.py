"""MJCF robots move as in MuJoCo: small generated chains with each kind of actuator, against its own engine."""

import random

import numpy as np
import pytest

from drake_twin import TwinBuilder

mujoco = pytest.importorskip("mujoco")

_STEP, _SECONDS = 2e-4, 2.0  # the twin's step; both engines are of the first order in it
_KINDS = {
    "motor": lambda rng: (f'<motor class="c" gear="{rng.choice((1, -3, 5))}"', "effort", 0.4),
    "position": lambda rng: (f'<position kp="{rng.choice((8, 20))}" kv="{rng.choice((1, 3))}"', "position", 0.5),
    "geared position": lambda rng: ('<position kp="4" kv="0.5" gear="2" ctrlrange="-0.6 0.9"', "position", 0.7),
    "weak position": lambda rng: ('<position kp="30" kv="2" forcerange="-1 1"', "position", -0.8),
    "velocity": lambda rng: (f'<velocity kv="{rng.choice((2, 6))}" gear="-2"', "velocity", 0.5),
    "general motor": lambda rng: ('<general gainprm="2" gear="2" ctrlrange="-0.1 0.05"', "effort", 0.9),
    "general position": lambda rng: ('<general biastype="affine" gainprm="15" biasprm="3 -30 -2"', "position", 0.4),
}


def chain(kinds, seed, extra=""):
    """Return the MJCF of a chain, and (joint, interface, command of the joint, ctrl) of each actuator."""
    rng = random.Random(seed)
    bodies, ends, actuators, commands = "", "", "", []
    for index, kind in enumerate(kinds):
        tag, interface, command = _KINDS[kind](rng)
        axis = rng.choice(("0 1 0", "1 0 0"))
        bodies += (
            f'<body name="b{index}" pos="0 0 {-0.3 if index else 0}"><joint name="j{index}" axis="{axis}" {extra}'
            f' damping="{rng.choice((0.05, 0.2))}" armature="{rng.choice((0.01, 0.05))}"/>'
            '<inertial pos="0.02 0 -0.15" mass="0.4" diaginertia="0.004 0.004 0.001"/></body>'
        )[: -len("</body>")]
        ends += "</body>"
        actuators += f'{tag} name="a{index}" joint="j{index}"/>'
        commands.append((f"j{index}", interface, command))
    text = (
        '<mujoco model="m"><compiler angle="radian"/>'
        '<default><default class="c"><general ctrlrange="-2 2"/></default></default>'
        f"<worldbody>{bodies}{ends}</worldbody><actuator>{actuators}</actuator></mujoco>"
    )
    return text, commands


def in_mujoco(text, commands, times):
    """Return the positions in MuJoCo, with its most exact integrator: the others are of the first order."""
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.timestep, model.opt.integrator = _STEP / 2, mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(model)
    data.ctrl[:] = [_ctrl(model, index, kind, command) for index, (_, kind, command) in enumerate(commands)]
    rows = []
    for time in times:
        mujoco.mj_step(model, data, round((time - data.time) / model.opt.timestep))
        rows.append(data.qpos.copy())
    return np.array(rows)


def _ctrl(model, actuator, interface, command):
    """Return the control of an actuator for a command of its joint."""
    gear, gain = model.actuator_gear[actuator, 0], model.actuator_gainprm[actuator, 0]
    bias = model.actuator_biasprm[actuator]
    if interface == "effort":
        return command / (gear * gain)
    return command * gear if interface == "velocity" else (-bias[1] * command * gear - bias[0]) / gain


def in_the_twin(folder, text, commands, times, engine):
    (folder / "robot.xml").write_text(text)
    builder = TwinBuilder(engine=engine, time_step=_STEP if engine == "discrete" else 1e-3, accuracy=1e-7)
    twin = builder.robot("r", folder / "robot.xml", xyz=(0, 0, 3)).build()
    for interface in dict.fromkeys(item[1] for item in commands):
        values = [command for _, kind, command in commands if kind == interface]
        twin.publish(f"/r/forward_{interface}_controller/commands", values)
    rows = []
    for time in times:
        twin.advance_to(time)
        state = twin.robot_state("r")
        rows.append([state.positions[state.joints.index(f"j{i}")] for i in range(len(commands))])
    return np.array(rows)


TIMES = np.linspace(0.0, _SECONDS, 21)
CHAINS = [
    *([kind] for kind in _KINDS),
    ["motor", "position"],
    ["velocity", "geared position", "general motor"],
    ["position", "weak position", "general position", "velocity"],
]


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
@pytest.mark.parametrize("kinds", CHAINS, ids="+".join)
def test_a_driven_chain_moves_as_in_mujoco(tmp_path, kinds, engine):
    text, commands = chain(kinds, len(kinds))
    ours, theirs = in_the_twin(tmp_path, text, commands, TIMES, engine), in_mujoco(text, commands, TIMES)
    assert np.abs(theirs).max() > 0.05
    assert ours == pytest.approx(theirs, abs=1e-3)


def test_a_spring_at_a_joint_acts_as_in_mujoco(tmp_path):
    text, commands = chain(["motor"], 3, 'stiffness="2" springref="0.4"')
    ours, theirs = in_the_twin(tmp_path, text, commands, TIMES, "discrete"), in_mujoco(text, commands, TIMES)
    assert ours == pytest.approx(theirs, abs=1e-3)


def test_dry_friction_brakes_as_in_mujoco(tmp_path):
    text, commands = chain(["motor"], 1, 'frictionloss="0.1"')
    times = TIMES[:6]  # while it moves: MuJoCo's friction is soft, and lets a joint at rest creep
    ours, theirs = in_the_twin(tmp_path, text, commands, times, "discrete"), in_mujoco(text, commands, times)
    without = in_mujoco(text.replace("frictionloss", "user"), commands, times)
    assert np.abs(theirs - without).max() > 0.05
    assert ours == pytest.approx(theirs, abs=1e-3)
