"""Bodies in the air, by plugins of gz-sim."""

import pytest

from drake_twin import TwinBuilder
from drake_twin.scenario import World

G, RHO = 9.8, 1.2041
STEPS = pytest.mark.parametrize("time_step", [0.001, 0.01])

_LINK = """<link name="{name}"><inertial><mass>{mass}</mass><inertia><ixx>{ixx}</ixx><iyy>{iyy}</iyy><izz>{izz}</izz>
</inertia></inertial></link>"""
_HINGE = """<joint name="hinge" type="revolute"><parent>body</parent><child>flap</child>
<axis><xyz>0 1 0</xyz></axis></joint>"""
FLAP = _LINK.format(name="flap", mass=1e-3, ixx=1e-6, iyy=1e-6, izz=1e-6) + _HINGE


def plugin(kind, elements):
    """The plugin of a class, LiftDrag or AdvancedLiftDrag, on the link ``body``."""
    library = {"LiftDrag": "lift-drag", "AdvancedLiftDrag": "advanced-lift-drag"}[kind]
    values = "".join(f"<{tag}>{value}</{tag}>" for tag, value in elements.items())
    return (
        f'<plugin filename="gz-sim-{library}-system" name="gz::sim::systems::{kind}"><link_name>body</link_name>'
        f"{values}</plugin>"
    )


def flyer(
    folder,
    plugins,
    gravity=0.0,
    inertia=(0.5, 0.8, 1.2),
    more="",
    time_step=0.01,
    pitch=0.0,
    world=None,
    **more_of_twin,
):
    """A twin of a body of 2 kg with plugins, in a world with gravity downwards (m/s²) or another one."""
    ixx, iyy, izz = inertia
    body = _LINK.format(name="body", mass=2.0, ixx=ixx, iyy=iyy, izz=izz)
    text = f'<sdf version="1.9"><model name="flyer">{body}{more}\n{plugins}</model></sdf>'
    (folder / "flyer.sdf").write_text(text)
    builder = TwinBuilder(world=world or World(gravity=(0.0, 0.0, -gravity)), time_step=time_step, **more_of_twin)
    return builder.robot("flyer", folder / "flyer.sdf", xyz=(0, 0, 500), rpy=(0, pitch, 0)).build()


def deflect(twin, angle):
    """Turns the flap (rad)."""
    context = twin.plant.GetMyMutableContextFromRoot(twin.context)
    twin.plant.GetJointByName("hinge").set_angle(context, angle)
