"""Places of the ranges that fit equally well: which of them are the same."""

import numpy as np
import pytest
from formulas import evaluations

from drake_twin.calibration.certainty import certainty
from drake_twin.calibration.fitted import Fitted


@pytest.mark.parametrize(("apart", "others"), [(0.02, 0), (0.045, 1)])
def test_places_within_three_hundredths_of_the_range_are_one(apart, others):
    """A motion that is the same at two places, each of which the log tells to a thousandth of the range."""

    def motion(times, place):
        return 100 * np.sin(3 * times) * ((place - 0.5) ** 2 - (apart / 2) ** 2)

    own = evaluations(motion, (0.5 + apart / 2,), (Fitted("place", 0.0, 1.0),), sigma=1e-3)
    ends = [own.at(np.array([0.5 + side * apart / 2])) for side in (-1, 1)]
    found = certainty(own, ends)
    assert found.best.cost < 2 * own.freedom
    assert len(found.others) == others
    assert [abs(found.best.point[0] - other.point[0]) for other in found.others] == pytest.approx(
        [apart] * others, rel=0.1
    )
