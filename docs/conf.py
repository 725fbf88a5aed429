"""How Sphinx builds these pages: Markdown by MyST, the API from docstrings, the examples by sphinx-gallery.

    python -m sphinx -W -b html docs build/docs      or: make docs
Nothing is fetched from a network. `-D plot_gallery=0` builds without running the examples.
"""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

import docstrings  # noqa: E402 - it lies beside this file

import rangenav  # noqa: E402

project = "rangenav"
author = "the rangenav contributors"
copyright = author
version = release = rangenav.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.autosummary", "formulas"]
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
exclude_patterns = ["api/generated/*.md", "**/README*"]

# Markdown that a git forge renders as well: formulas in $…$ and $$…$$, links between headings.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

# The API pages. Docstrings of this project are plain text with Unicode formulas: `docstrings` makes them RST.
default_role = "code"
templates_path = ["templates"]
autosummary_generate = True
autosummary_ignore_module_all = False
autodoc_default_options = {"members": True, "undoc-members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
python_maximum_signature_line_length = 88

WIDE = ("presets", "formats", "benchmarks", "departures")
"""Pages with wide tables: they get the whole width."""
html_math_renderer = "drawn"
html_theme = "pydata_sphinx_theme"
html_title = f"rangenav {version}"
html_static_path = ["_static"]
html_css_files = ["docs.css"]
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False
html_theme_options = {
    "show_toc_level": 2,
    "navigation_with_keys": False,
    "footer_start": [],
    "footer_end": [],
    "secondary_sidebar_items": {"**": ["page-toc"]} | {page: [] for page in WIDE},
}

# The examples run when the pages are built, so their figures are those of this version; a test runs them as well.
EXAMPLES = HERE.parent / "examples"
if any(EXAMPLES.glob("GALLERY_HEADER.*")):
    extensions.append("sphinx_gallery.gen_gallery")
    sphinx_gallery_conf = {
        "examples_dirs": [str(EXAMPLES)],
        "gallery_dirs": ["examples"],
        "filename_pattern": r"\.py$",
        "within_subsection_order": "FileNameSortKey",
        "abort_on_example_error": True,
        "show_memory": False,
        "show_signature": False,
        "download_all_examples": False,
        "remove_config_comments": True,
        "min_reported_time": 1e9,
    }


def without_gallery(app, name, source):
    """Leave the examples out of the table of contents where there are none."""
    if name == "index" and not any(EXAMPLES.glob("GALLERY_HEADER.*")):
        source[0] = source[0].replace("\nexamples/index\n", "\n")


def setup(app):
    """Connect the hooks that make docstrings and annotations readable."""
    app.connect("source-read", without_gallery)
    app.connect("autodoc-process-docstring", docstrings.process)
    app.connect("autodoc-process-signature", docstrings.shorten)
    app.connect("autodoc-skip-member", docstrings.skip)


suppress_warnings = ["ref.python"]  # `range` in a signature is Python's, not one of the fields of that name
