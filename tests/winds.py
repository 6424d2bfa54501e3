"""Worlds with gz-sim's WindEffects, and bodies in them, as SDF."""

from drake_twin import TwinBuilder
from drake_twin.scenario import World

STEPS = (0.001, 0.01)
AT_ONCE = 1e-9  # s, of a rise


def effects(
    factor=None,
    rise=AT_ONCE,
    turn=AT_ONCE,
    climb=AT_ONCE,
    *,
    swing="",
    veer="",
    noise="",
    turn_noise="",
    climb_noise="",
):
    """SDF of gz-sim's WindEffects; its times of rise, and what else is in its elements."""
    scaling = (
        "" if factor is None else f"<force_approximation_scaling_factor>{factor}</force_approximation_scaling_factor>"
    )
    return f"""<plugin filename="gz-sim-wind-effects-system" name="gz::sim::systems::WindEffects">{scaling}<horizontal>
<magnitude><time_for_rise>{rise}</time_for_rise>{swing}{noise}</magnitude>
<direction><time_for_rise>{turn}</time_for_rise>{veer}{turn_noise}</direction></horizontal>
<vertical><time_for_rise>{climb}</time_for_rise>{climb_noise}</vertical></plugin>"""


def sinusoid(name, amplitude, period):
    return f"<sin><{name}>{amplitude}</{name}><period>{period}</period></sin>"


def gaussian(stddev):
    return f'<noise type="gaussian"><mean>0</mean><stddev>{stddev}</stddev></noise>'


def body(name, pose="0 0 0 0 0 0", *, of_model="true", of_link="", mass=2.0, low=0.0, more=""):
    """SDF of a box of 0.5 m, with its center of mass below its middle by ``low`` (m), and flags for the wind."""
    inertia = "".join(f"<i{axis * 2}>{mass * 0.5**2 / 6}</i{axis * 2}>" for axis in "xyz")
    flag = f"<enable_wind>{of_link}</enable_wind>" if of_link else ""
    of_model = f"<enable_wind>{of_model}</enable_wind>" if of_model else ""
    return f"""<model name="{name}"><pose>{pose}</pose>{of_model}<link name="hull">{flag}<inertial>
<pose>0 0 {-low} 0 0 0</pose><mass>{mass}</mass><inertia>{inertia}</inertia></inertial>
<collision name="c"><geometry><box><size>0.5 0.5 0.5</size></box></geometry>
<surface><friction><ode><mu>0.2</mu><mu2>0.2</mu2></ode></friction></surface></collision></link>{more}</model>"""


GROUND = """<model name="ground"><static>true</static><link name="l"><collision name="c"><geometry><plane/></geometry>
<surface><friction><ode><mu>0.2</mu><mu2>0.2</mu2></ode></friction></surface></collision></link></model>"""


def windy_world(folder, inside, wind="0 0 0", gravity=0.0):
    """A world's file."""
    file = folder / "windy.sdf"
    file.write_text(
        f'<sdf version="1.9"><world name="w"><gravity>0 0 {-gravity}</gravity>'
        f"<wind><linear_velocity>{wind}</linear_velocity></wind>\n{inside}</world></sdf>"
    )
    return file


def blown(folder, inside, step=0.001, *, wind="4 0 0", gravity=0.0, robots=None, **options):
    """A twin of a world with models and plugins in it, and robots: name → their SDF."""
    builder = TwinBuilder(time_step=step, world=World(file=str(windy_world(folder, inside, wind, gravity))), **options)
    for name, text in (robots or {}).items():
        (folder / f"{name}.sdf").write_text(f'<sdf version="1.9">{text}</sdf>')
        builder.robot(name, folder / f"{name}.sdf", xyz=(0, 0, 5))
    return builder.build()


def velocity(twin, name="b"):
    return twin.entities.state(name).linear


def air(twin):
    """The velocity of the wind, as it is published."""
    found = twin.latest("/world/w/wind_info")
    return found.x, found.y, found.z
