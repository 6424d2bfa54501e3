"""How Sphinx builds these pages: ``python -m sphinx -W --keep-going drake_twin/docs build/docs``."""

import sys
from pathlib import Path

from drake_twin import __version__

sys.path.insert(0, str(Path(__file__).parent))

project = "drake_twin"
author = "the drake_twin contributors"
version = release = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "pydrake_system"]
html_theme = "furo"
html_show_copyright = False
html_title = f"drake_twin {version}"
html_static_path = ["tables.css"]
html_css_files = ["tables.css"]

myst_heading_anchors = 3
default_role = "py:obj"  # `Twin` in a docstring is a link where Twin is documented

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
napoleon_numpy_docstring = False
napoleon_use_ivar = True
python_use_unqualified_type_names = True
