"""The manual, built by Sphinx: ``make manual``, without a network, with warnings as errors."""

import os
import sys
from pathlib import Path

_DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(_DOCS.parent), str(_DOCS / "site")]
# examples and docstrings are read, nothing is compiled
os.environ.setdefault("NUMBA_DISABLE_JIT", "1")

import generated_pages  # noqa: E402

import chatter  # noqa: E402

project = "chatter"
author = "The chatter authors"
copyright = "the chatter authors, MIT licence"  # noqa: A001
release = version = chatter.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinxcontrib.bibtex",
    "sphinx_copybutton",
    "mathml",
    "outside_links",
    "plain_bars",
]
exclude_patterns = ["site", "_build"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

myst_enable_extensions = ["dollarmath", "deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 4
suppress_warnings = ["misc.highlighting_failure"]
math_numfig = True
numfig = True

bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "plain"
bibtex_reference_style = "author_year"

autodoc_typehints = "none"  # types stand in the signatures
autodoc_member_order = "bysource"
napoleon_numpy_docstring = True
napoleon_google_docstring = False
napoleon_use_rtype = False
python_use_unqualified_type_names = True
copybutton_selector = "div.highlight-sh pre, div.highlight-python pre, div.highlight-toml pre"

html_theme = "furo"
html_title = f"chatter {release}"
html_static_path = []
html_copy_source = False
html_show_sphinx = False

generated_pages.write(_DOCS / "generated")
