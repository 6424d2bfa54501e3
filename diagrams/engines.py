"""Which engine: fixed steps that repeat to the last bit, or error control that takes long steps where it can.

Run it: python diagrams/engines.py
"""

from time import perf_counter

from drake_twin import TwinBuilder

ROVER = "package://rover_description/urdf/rover.urdf.xacro"


def run(**options):
    """Drive two rovers for four seconds; return the real-time factor, where one ended (m) and the state's hash."""
    builder = TwinBuilder(**options)
    for number in range(2):
        builder.robot(f"robot_{number}", ROVER, xyz=(0, 2 * number, 0.13))
        builder.command(f"/robot_{number}/forward_velocity_controller/commands", [5.0] * 4)
    twin = builder.build()
    start = perf_counter()
    twin.advance_to(4.0)
    factor = 4.0 / (perf_counter() - start)
    return factor, twin.robot_state("robot_0").base_pose[0], twin.state_sha256()


cases = {
    "discrete, 1 ms": {"time_step": 0.001},
    "discrete, 10 ms": {"time_step": 0.01},
    "cenic, 1e-3": {"engine": "cenic", "accuracy": 1e-3, "time_step": 0.05},
}
results = {case: run(**options) for case, options in cases.items()}
for case, (factor, x, sha256) in results.items():
    print(f"{case:15}  real-time factor {factor:7.1f}  x {x:.4f} m  state {sha256[:12]}")

assert run(**cases["discrete, 10 ms"])[2] == results["discrete, 10 ms"][2]
ends = [x for _, x, _ in results.values()]
assert max(ends) - min(ends) < 0.02
