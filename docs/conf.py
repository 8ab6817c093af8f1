"""Configuration of the documentation's build."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "_ext"))

project = "tether"
author = "tether developers"
release = version_of("tether")
version = release

extensions = ["myst_parser", "sphinx.ext.mathjax", "tether_reference"]
myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
exclude_patterns = ["_build"]
nitpicky = True

html_theme = "furo"
html_title = f"tether {release}"
