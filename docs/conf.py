"""Settings of the documentation site: `make docs` builds it into docs/_build, without a network.

The pages are the Markdown files of this folder, which can also be read where they lie. The gallery, from
`examples`, and a page for each name of the interface are made with the site.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive
from numpydoc.xref import DEFAULT_LINKS
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

import asperity
from asperity.cli.parser import make_parser

os.environ["COLUMNS"] = "96"  # width of the help of commands

project = "asperity"
author = "The asperity developers"
release = version = asperity.__version__
copyright = author

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx-mathjax-offline",  # MathJax among the files of the site instead of a network address
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "gallery/**/*.ipynb", "gallery/**/*.md5", "gallery/**/*.py"]
templates_path = ["_templates"]
nitpicky = True
suppress_warnings = ["sphinx_gallery.space_in_filename"]  # of the folder of the clone, which no link names

# Markdown
myst_enable_extensions = ["amsmath", "dollarmath"]
myst_fence_as_directive = ["math"]  # as GitHub renders it
myst_heading_anchors = 4

# Interface
autosummary_generate = True
autodoc_typehints = "none"  # types stand in the lists of parameters
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_xref_param_type = True  # public names in the lists of parameters are links
LISTED = re.findall(r"~(asperity\.[\w.]+)", (Path(__file__).parent / "api.rst").read_text("utf-8"))
numpydoc_xref_aliases = {name.rpartition(".")[2]: name for name in LISTED}
numpydoc_xref_ignore = "all"
DEFAULT_LINKS.clear()  # int, float, array, … would link to sites of others
default_role = "py:obj"
copybutton_prompt_text = r">>> |\.\.\. "
copybutton_prompt_is_regexp = True

# Appearance
html_theme = "furo"
html_title = f"asperity {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"footer_icons": []}

# Gallery
sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/plot_",
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": True,
    "remove_config_comments": True,
    "min_reported_time": 1e9,
    "write_computation_times": False,
    "reset_modules": ("matplotlib",),
    "matplotlib_animations": False,
    "image_srcset": ["2x"],
    "doc_module": ("asperity",),
    "backreferences_dir": "gallery/uses",
    "inspect_global_variables": False,
}

PAGES = {"../config/README.md": "settings.md", "../CHANGELOG.md": "changelog.md", "../README.md": "index.md"}
"""Files outside this folder that the pages link to, and the pages that show them."""


def link_to_pages(app: Sphinx, name: str, content: list[str]) -> None:
    """Links between files of the repository become links between pages, and names of pages their titles."""
    text = content[0]
    for target, page in PAGES.items():
        text = text.replace(f"]({target}", f"]({page}")
    text = text.replace("](../docs/", "](").replace("](docs/", "](")
    text = re.sub(r"\[([^]]+)\]\(\.\./([\w/.]+?)(/README\.md)?(#[\w-]+)?\)", r"\1 (`\2`)", text)
    text = re.sub(r"\[(?:docs/|config/)?\w+\.md\]\(", "[](", text)
    text = re.sub(r"`(results/[\w/]+\.html)`", r'<a href="\1">\1</a>', text)
    content[0] = re.sub(r"`docs/(\w+\.md)`", r"[](\1)", text)


def link_included(app: Sphinx, relative_path: Path, parent: str, content: list[str]) -> None:
    """The same for files that a page includes."""
    link_to_pages(app, parent, content)


def write_results(app: Sphinx) -> None:
    """A finished report and the page of a sample, which the first page names."""
    folder = Path(app.outdir, "results")
    folder.mkdir(parents=True, exist_ok=True)
    maps = sorted((Path(asperity.__file__).parent / "engineering/maps").glob("ground_*.x3p"))
    answers = [asperity.run(path, {"material": "100Cr6"}, mean_pressure="50 MPa") for path in maps]
    for answer in answers:  # to which the page of the sample links
        (folder / answer.face.name).mkdir(exist_ok=True)
        (folder / answer.face.name / "report.html").write_text(answer.report(), encoding="utf-8")
    (folder / "sample.html").write_text(asperity.pool(answers).report(), encoding="utf-8")


def escape_bars(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    """A magnitude |q| in a docstring is no substitution of reStructuredText."""
    for number, line in enumerate(lines):
        if not line.lstrip().startswith((">>>", "...")):
            parts = re.sub(r"``docs/(\w+)\.md``", r":doc:`/\1`", line).split("``")
            parts[::2] = [part.replace("|", r"\|") for part in parts[::2]]
            lines[number] = "``".join(parts)


def link_names(
    app: Sphinx, env: BuildEnvironment, node: nodes.Element, shown: nodes.Element
) -> nodes.Node | None:
    """A name between single backquotes of a docstring links to its page if it is public, and else is code."""
    if node.get("reftype") != "obj" or not node["refdoc"].startswith("api"):
        return None
    name = numpydoc_xref_aliases.get(str(node["reftarget"]).rpartition(".")[2])
    if name is None:
        return shown
    page, python = node["refdoc"], env.get_domain("py")
    return python.resolve_xref(env, page, app.builder, "obj", name, node, shown)


class Commands(Directive):
    """A section for each command of ``asperity`` with its help."""

    def run(self) -> list[nodes.Node]:
        """The sections, in the order of the command line."""
        parser = make_parser()
        (commands,) = (action.choices for action in parser._actions if isinstance(action.choices, dict))
        sections = []
        for name, command in commands.items():
            title = f"asperity {name}"
            section = nodes.section(ids=[nodes.make_id(title)], names=[nodes.fully_normalize_name(title)])
            section += nodes.title(text=title)
            section += nodes.literal_block(text=command.format_help(), language="none")
            sections.append(section)
        return sections


def setup(app: Sphinx) -> None:
    """Connect the handlers and directives of this file."""
    app.add_directive("commands", Commands)
    app.connect("builder-inited", write_results)
    app.connect("source-read", link_to_pages)
    app.connect("include-read", link_included)
    app.connect("autodoc-process-docstring", escape_bars)
    app.connect("missing-reference", link_names)
