import re
from pathlib import Path

import drake_twin
from drake_twin.description.drake_urdf import DRAKE_RULES
from drake_twin.description.repairs import REPAIRS


def test_the_documentation_lists_every_rule_and_no_other():
    text = (Path(drake_twin.__file__).parent / "docs" / "repairs.md").read_text()
    table = text[text.index("## Repairs") : text.index("Refused")]
    assert set(re.findall(r"^\| `(\w+)`", table, re.MULTILINE)) == {*REPAIRS, *DRAKE_RULES}
