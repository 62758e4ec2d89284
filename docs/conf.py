"""How the site is built: `make docs`, or `sphinx-build -W docs docs/_build/html` with `cayley[docs]` installed."""

import logging
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

import staging  # noqa: E402

import cayley  # noqa: E402

logging.getLogger("cayley").setLevel(logging.WARNING)  # the gallery turns on all messages of the examples

project = "cayley"
author = "cayley developers"
version = release = cayley.__version__
project_copyright = "2026, cayley developers, MIT license"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.linkcode",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
    "sphinx-mathjax-offline",  # formulas are set without the internet
    "docstrings",
    "pages",
    "sources",
]
exclude_patterns = ["_build", "_ext", "_staged", "images", "**/GALLERY_HEADER.rst", "sg_execution_times.rst"]
default_role = "code"  # docstrings have one backtick around code
suppress_warnings = ["config.cache"]  # the gallery's settings hold functions

myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
myst_url_schemes = ("http", "https", "mailto", "source")  # source: a file of the repository, see _ext/sources.py

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True, "exclude-members": "__init__"}
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 100
napoleon_numpy_docstring = False
napoleon_custom_sections = [("Attributes", "params_style")]
napoleon_use_rtype = False

sphinx_gallery_conf = {
    "examples_dirs": [str(staging.stage())],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"\.py$",  # run them all
    "ignore_pattern": r"__init__",
    "within_subsection_order": "ExampleTitleSortKey",
    "thumbnail_size": (400, 260),
    "abort_on_example_error": True,
    "image_scrapers": ("matplotlib", staging.bare_figure),
    "reset_modules": (staging.figure_style,),
    "show_memory": False,
    "plot_gallery": "True",
    "remove_config_comments": True,
    "download_all_examples": False,
    "show_signature": False,
    "copyfile_regex": r".*\.rst",
}

html_theme = "furo"
html_title = f"cayley {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False

linkcheck_anchors = False
linkcheck_timeout = 10
linkcheck_ignore = [r"source:.*"]


def linkcode_resolve(domain: str, info: dict[str, str]) -> str | None:
    """Where the source of an object of the API is shown."""
    import sources

    return sources.of_object(info["module"], info["fullname"]) if domain == "py" else None
