"""How the site is built; ``make docs`` does it."""

import os
import sys
from pathlib import Path

import yaml

import susp_ss

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE / "extensions"))

project = "susp_ss"
copyright = "2026, the susp_ss developers"
version = release = susp_ss.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_nb",
    "command_line",
    "examples",
    "explorer",
    "lessons",
    "mathml",
    "references",
]
exclude_patterns = ["_build", "extensions", "templates"]
templates_path = ["templates"]

# Every name that a page or a docstring points to must exist.
nitpicky = True
default_role = "py:obj"
# Two hyphens begin an option.
smartquotes = False
nitpick_ignore = [("py:obj", name) for name in ("inf", "FACTORS", "LowFidelityResponse", "UNITS")]
# What damper and spring curves share; each says it of itself.
nitpick_ignore += [("py:class", "susp_ss.vehicles.curves.Curve")]

autosummary_generate = True
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_inherit_docstrings = False
# What a class has from its kind is told there, and what it has from scikit-learn, elsewhere.
autodoc_default_options = {
    "inherited-members": "Vehicle, Surrogate, BaseEstimator, RegressorMixin, _MetadataRequester, object, tuple",
    "exclude-members": "set_fit_request, set_predict_request, set_score_request",
}
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"

myst_enable_extensions = ["deflist", "dollarmath", "fieldlist", "attrs_inline", "substitution"]
myst_heading_anchors = 3
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
myst_substitutions = {
    "bib_author": f"{{{CITATION['authors'][0]['name']}}}",
    "bib_title": f"{{{CITATION['title']}}}",
    "bib_version": f"{{{version}}}",
}
myst_dmath_double_inline = True

# Pages with cells run as they are built. Lessons show the run that is committed, which the tests repeat.
nb_execution_mode = "force"
nb_execution_excludepatterns = ["lessons/*"]
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = -1
nb_merge_streams = True
nb_output_stderr = "error"
os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"
# Kernels of their own settings, so that nobody's own reach the pages; quiet about running on this machine.
os.environ["IPYTHONDIR"] = str(HERE / "_build" / "ipython")
PROFILE = HERE / "_build" / "ipython" / "profile_default"
PROFILE.mkdir(parents=True, exist_ok=True)
(PROFILE / "ipython_kernel_config.py").write_text("c.IPKernelApp.log_level = 40\n", encoding="utf-8")

html_theme = "pydata_sphinx_theme"
html_title = "susp_ss"
html_context = {"default_mode": "auto"}
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
# A browser may not read pages that lie in a folder, which a summary of each find would need.
html_show_search_summary = False
html_theme_options = {
    "logo": {"text": "susp_ss"},
    "navbar_align": "left",
    "header_links_before_dropdown": 8,
    "show_prev_next": True,
    "show_nav_level": 1,
    "show_toc_level": 2,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
# Pages without others below them.
ALONE = ("index", "start", "explorer", "command-line", "limits", "benchmarks", "cite", "changelog")
html_sidebars = {page: [] for page in ALONE}
