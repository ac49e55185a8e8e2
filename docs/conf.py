"""Configuration of the documentation site: everything is local, and a warning is an error."""

from __future__ import annotations

import os
import shutil
import sys
from importlib.metadata import version as version_of
from pathlib import Path
from typing import TYPE_CHECKING

from pygments.lexers.special import TextLexer

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

# Sphinx reads what is below this folder only; the copies are no part of the repository.
for notebook in sorted((HERE.parent / "notebooks").glob("*.ipynb")):
    (HERE / "notebooks").mkdir(exist_ok=True)
    shutil.copyfile(notebook, HERE / "notebooks" / notebook.name)

project = "srgc"
author = "the srgc authors"
copyright = "the srgc authors, MIT licence"  # noqa: A001
release = version = version_of("srgc")

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "_extensions.generated_pages",
    "_extensions.glossary_links",
    "_extensions.mathml",
    "_extensions.playground_link",
    "_extensions.type_links",
]
exclude_patterns = ["_extensions", "_templates", "_build", "decisions/README.md"]
templates_path = ["_templates"]
nitpicky = True
# Annotations name classes without their modules, of which only those of this site are found, and
# names of other packages, whose pages are elsewhere.
nitpick_ignore_regex = [
    (r"py:.*", r"[^.]*"),
    (r"py:.*", r"(collections|decimal|fractions|matplotlib|networkx)\..*"),
    (r"py:.*", r"(np|numpy|os|pathlib|typing)\..*"),
    (r"py:.*", r"(grammar_lang|compiler|solvers|srgc)\..*"),
]

# Markdown as GitHub reads it: headings have the same fragments there.
myst_enable_extensions = ["amsmath", "deflist", "dollarmath", "fieldlist"]
myst_heading_anchors = 6
# Specs that are shown for their mistakes have tokens that are none; tests/srgc/test_highlighting.py
# looks at all others.
suppress_warnings = ["misc.highlighting_failure"]

# Notebooks are run by `make docs`; a build that sets SRGC_DOCS_RUN=off shows what is stored.
nb_execution_mode = os.environ.get("SRGC_DOCS_RUN", "cache")
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 600
nb_ipywidgets_js: dict[str, dict[str, str]] = {}

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_display_short_literal_types = True

html_theme = "furo"
html_title = f"srgc {release}"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["srgc.css"]
html_js_files = ["srgc.js"]
html_copy_source = False
html_show_sourcelink = False
html_last_updated_fmt = None
html_search_scorer = str(HERE / "_extensions" / "search_order.js")
html_theme_options = {"navigation_with_keys": True}
pygments_style = "default"
pygments_dark_style = "github-dark"

# A prompt is not copied, nor what a command answers.
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
copybutton_remove_prompts = True


def setup(app: Sphinx) -> None:
    """What `srgc check` prints is shown as it is."""
    app.add_lexer("diagnostics", TextLexer)
    app.add_lexer("ebnf", TextLexer)
