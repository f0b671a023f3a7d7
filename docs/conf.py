"""Settings of the documentation site; scripts/build_docs calls sphinx-build with them."""

import os
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE / "extensions"))
sys.path.insert(0, os.environ["CSRBF_PYTHON"])  # the folder of the module csrbf

project = "csrbf"
copyright = "the csrbf authors"
version = release = re.search(r"VERSION (\d+\.\d+\.\d+)", (ROOT / "CMakeLists.txt").read_text()).group(1)

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "program_help", "cpp_header", "python_names"]
root_doc = "docs/index"
include_patterns = ["docs/**", "benchmarks/*.md", "CHANGELOG.md", "CONTRIBUTING.md"]
exclude_patterns = ["build", ".git"]

myst_heading_anchors = 3
suppress_warnings = ["myst.header"]  # pages of records start their sections where they like


default_role = "py:obj"  # `name` in docstrings
autodoc_member_order = "bysource"
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_rtype = False

html_theme = "furo"
html_title = f"csrbf {version}"
html_static_path = ["style"]
html_css_files = ["csrbf.css"]
html_show_sourcelink = False
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
