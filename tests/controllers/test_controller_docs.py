import dataclasses
from pathlib import Path

import drake_twin
from drake_twin.controllers.deviations import DEVIATIONS
from drake_twin.controllers.docs import controllers_page
from drake_twin.controllers.registry import controller_class, controller_types


def own_types():
    """The twin's own controller types, without those that other tests have registered."""
    return [name for name in controller_types() if controller_class(name).__module__.startswith("drake_twin.")]


def test_the_page_is_what_the_parameters_classes_say():
    # python -m drake_twin.controllers.docs > drake_twin/docs/controllers.md
    page = Path(drake_twin.__file__).parent / "docs" / "controllers.md"
    assert page.read_text(encoding="utf-8") == controllers_page()


def test_every_controller_type_is_on_the_page_and_every_parameter_has_a_meaning():
    page = controllers_page()
    for name in own_types():
        assert f"`{name}`" in page
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    assert [row for row in rows if row.split("|")[-2].strip() == ""] == []


def test_the_page_tells_defaults_bounds_and_why_a_parameter_is_ignored():
    lines = controllers_page().splitlines()
    assert any(line.startswith("| `stall_timeout` | number | `1.0` |") for line in lines)
    assert any(line.startswith("| `gains.<joint>.u_clamp_max` | number | `.inf` |") for line in lines)
    (choices,) = [line for line in lines if line.startswith("| `reference_and_state_interfaces` | list of texts | req")]
    assert choices.endswith("one of `position`, `velocity` |")
    assert any(
        "`action_monitor_rate`" in line and "at least 0.1; *ignored*: the end of a goal" in line for line in lines
    )


def test_each_controller_has_a_frozen_parameters_class():
    for name in own_types():
        parameters = controller_class(name).Parameters
        assert dataclasses.is_dataclass(parameters)
        assert parameters.__dataclass_params__.frozen


def test_each_difference_from_upstream_is_a_row_with_its_reason():
    lines = controllers_page().splitlines()
    for item in DEVIATIONS:
        cells = (item.of, item.behavior, item.upstream, item.twin, item.why)
        assert all(cell and "|" not in cell for cell in cells)
        assert f"| {' | '.join(cells)} |" in lines
    assert len({(item.of, item.behavior) for item in DEVIATIONS}) == len(DEVIATIONS)
