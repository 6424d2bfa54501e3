"""What docs/mirror.md says about bags, done as a reader would."""

import pytest
from docs.draw_mirror import done


@pytest.mark.thorough
def test_the_page_ends_with_a_found_fault(tmp_path, capsys):
    assert done(tmp_path) == [0, 0, 0, 3]
    said = capsys.readouterr().out
    assert "no alarm" in said
    assert "robot_1_rear_right_wheel_joint reaches only 60% of its commanded velocity" in said
    assert "motor_weak" in (tmp_path / "today.html").read_text()
