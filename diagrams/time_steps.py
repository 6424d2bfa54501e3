"""Lesson 1, second half: the physics step, 0.001 s against 0.01 s.

Run it: python diagrams/time_steps.py

A larger step costs less computing time per simulated second, so the real-time factor rises. It changes the motion
a little. The step can be changed while the twin runs.
"""

from time import perf_counter

from drake_twin import TwinBuilder

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
COMMANDS = "/arm/forward_velocity_controller/commands"
END = 4.0  # s


def run(time_step):
    """Return the real-time factor and the positions of the joints at the end (rad)."""
    twin = TwinBuilder(time_step=time_step).robot("arm", ARM).command(COMMANDS, [0.3, 0.2, -0.2, 0.1]).build()
    start = perf_counter()
    twin.advance_to(END)
    return END / (perf_counter() - start), twin.robot_state("arm").positions


fine_factor, fine = run(0.001)
coarse_factor, coarse = run(0.01)
largest = max(abs(a - b) for a, b in zip(fine, coarse, strict=True))
print(f"step 0.001 s: real-time factor {fine_factor:6.1f}")
print(f"step 0.01 s:  real-time factor {coarse_factor:6.1f}, positions differ by {largest:.1e} rad at most")

twin = TwinBuilder(time_step=0.001).robot("arm", ARM).build()
twin.advance_to(1.0)
twin.clock.set_time_step(0.01)  # takes effect at the next multiple of 0.01 s
twin.step(5)
assert abs(twin.time - 1.05) < 1e-9
assert largest < 0.01
