"""Shapes of 0.1 mm to 1 km rest where geometry says; thinner, lighter and heavier things do not end the run."""

import numpy as np
import pytest
from scenes import Scene, box, cylinder, every_engine, position, sphere, thing, velocity

SIZES = (1e-4, 1e-2, 1.0, 1e3)  # m

# What touches in a point sinks by g / 1e5 = 0.0981 mm, faces by a quarter of that at most.
SINKS = 1.0e-4


def of_size(kind: str, size: float) -> str:
    """URDF of a compact thing as tall as ``size`` (m), of the density of water and 1 g to 1 t."""
    mass = min(max(1000 * size**3, 1e-3), 1e3)
    if kind == "box":
        return box((size, size, size), mass)
    return cylinder(size / 2, size, mass) if kind == "cylinder" else sphere(size / 2, mass)


@every_engine
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere"])
def test_what_is_set_down_rests_at_half_its_height(tmp_path, kind, size, engine):
    twin = Scene(tmp_path, engine).add("thing", of_size(kind, size), (0, 0, size / 2 + 1e-6)).build()
    twin.advance_to(1.0)
    above = position(twin, "thing")[2] - size / 2
    assert -SINKS <= above <= 1e-6
    assert np.linalg.norm(velocity(twin, "thing")) < 1e-3
    assert twin.findings.warnings == ()


@every_engine
@pytest.mark.parametrize("thickness", [1e-9, 1e-6, 1e-4])
@pytest.mark.parametrize("mass", [0.005, 1.0])
@pytest.mark.parametrize("kind", ["plate", "disc", "cube"])
def test_what_is_thin_does_not_end_the_run_where_it_falls(tmp_path, kind, mass, thickness, engine):
    """Their corners and rims were so stiff that the solvers failed."""
    shape, moments = {
        "plate": (f'<box size="0.2 0.2 {thickness}"/>', (0.04, 0.04, 0.08)),
        "disc": (f'<cylinder radius="0.1" length="{thickness}"/>', (0.03, 0.03, 0.06)),
        "cube": (f'<box size="{thickness} {thickness} {thickness}"/>', (0.04, 0.04, 0.08)),
    }[kind]
    urdf = thing(shape, mass, [mass / 12 * moment for moment in moments])
    twin = Scene(tmp_path, engine).add("thing", urdf, (0, 0, 0.3)).build()
    twin.advance_to(0.6)
    assert abs(position(twin, "thing")[2]) < 0.1  # at 10 ms it sinks by what it falls in a step; discs tumble
    said = [warning for warning in twin.findings.warnings if f"{thickness:.3g} m thin" in warning]
    assert len(said) == (thickness < 1e-4)


@every_engine
@pytest.mark.parametrize("mass", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("size", [1e-2, 1.0])
def test_what_is_light_or_heavy_rests_at_half_its_height(tmp_path, size, mass, engine):
    twin = Scene(tmp_path, engine).add("thing", box((size, size, size), mass), (0, 0, size / 2 + 0.01)).build()
    twin.advance_to(1.0)
    assert -SINKS <= position(twin, "thing")[2] - size / 2 <= 1e-6
    assert twin.findings.warnings == ()


@pytest.mark.parametrize(
    ("urdf", "what"),
    [
        (box((1e-6,) * 3), "a collision shape of body is 1e-06 m thin"),
        (sphere(4e-5), "a collision shape of body is 8e-05 m thin"),
        (thing('<capsule radius="1e-5" length="1"/>', 1, (1, 1, 1)), "a collision shape of body is 2e-05 m thin"),
        (box((1e6,) * 3, 1e-3), "a collision shape of body is 1e+06 m large"),
        (box((0.1,) * 3, 1e-7), "body weighs 1e-07 kg: contact is made for 1e-6 kg and more"),
        (box((0.1,) * 3, 1e9), "body bears 1e+09 kg: contact is made for 1e8 kg at most"),
    ],
)
def test_what_contact_is_not_made_for_is_said(tmp_path, urdf, what):
    twin = Scene(tmp_path, "1ms").add("thing", urdf, (0, 0, 1e6)).build()
    (warning,) = (warning for warning in twin.findings.warnings if "touches in a point" not in warning)
    assert warning.startswith(f"thing: {what}")
