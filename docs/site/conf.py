# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual: Sphinx on the Markdown pages as they lie in the project, which code-hosting sites show as well.

The pages have no directives. What a site needs beyond them is added while they are read:
- docs/index.md and docs/reports/index.md list the pages under headings; these lists become the tables of contents at the side.
- docs/reports and studies are a book of their own, which the search leaves out.
- docs/api/cpp.md names namespaces and headers (docs/build.sh gives those headers to Doxygen); what they declare follows each namespace.
- docs/api/python.md names modules, likewise.
"""
import os
import re

project = "PAMR"
author = "The PAMR authors"
copyright = "The PAMR authors, GPL-3.0-or-later"
here = os.path.dirname(os.path.abspath(__file__))
root = os.path.dirname(os.path.dirname(here))
with open(os.path.join(root, "lib", "pamr", "base", "version.hpp"), encoding="utf-8") as file:
    version = release = ".".join(re.findall(r"^#define PAMR_VERSION_\w+ (\d+)$", file.read(), re.M))

extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc"]
root_doc = "docs/index"
include_patterns = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md", "docs/api/*.md", "docs/reports/*.md", "docs/tools/*.md",
                    "docs/tutorials/**.md", "cases/*/README.md", "studies/*/README.md"]
exclude_patterns = ["build", "out", ".git", "tests", "lib", "geometry", "tools", "scripts", "cmake", "**/out"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]
html_theme = "furo"
html_title = f"PAMR {version}"
html_static_path = ["static"]
html_css_files = ["manual.css"]
html_copy_source = False
html_show_sphinx = False
highlight_language = "none"

breathe_projects = {"pamr": os.environ.get("PAMR_DOXYGEN", "")}
breathe_default_project = "pamr"
breathe_default_members = ("members",)
autodoc_mock_imports = ["numpy", "mpi4py", "meshio", "dolfinx", "pamr._core"]
autodoc_typehints = "description"
autodoc_member_order = "bysource"

LIST_LINK = re.compile(r"^- \[([^\]]+)\]\(([^)#:]+\.md)\)", re.M)
NAMESPACE = re.compile(r"^(## `(pamr::\w+)`\n\n(?:.+\n)+)", re.M)
MODULE = re.compile(r"^(#+) `(pamr(?:\.\w+)*)`.*$", re.M)


def tables_of_contents(text):
    """The lists of links under each second-level heading, once more as hidden tables of contents."""
    tables = []
    for part in re.split(r"^## ", text, flags=re.M)[1:]:
        title, body = part.split("\n", 1)
        pages = [f"{name} <{target[:-3]}>" for name, target in LIST_LINK.findall(body)]
        if pages:
            tables.append("```{toctree}\n:hidden:\n:caption: " + title.strip() + "\n\n" + "\n".join(pages) + "\n```\n")
    return text + "\n" + "\n".join(tables)


def leave_reports_out_of_the_search(app, docname, source):
    if docname.startswith(("docs/reports/", "studies/")):
        source[0] = "---\nnosearch: true\n---\n\n" + source[0]


def add_interfaces(app, docname, source):
    if docname in (root_doc, "docs/reports/index"):
        source[0] = tables_of_contents(source[0])
    elif docname == "docs/api/cpp":
        source[0] = NAMESPACE.sub(r"\1\n```{doxygennamespace} \2\n:members:\n:content-only:\n:undoc-members:\n```\n", source[0] + "\n")
    elif docname == "docs/api/python":
        source[0] = MODULE.sub(lambda m: f"{m.group(0)}\n\n```{{eval-rst}}\n.. automodule:: {m.group(2)}\n   :members:\n```\n", source[0])


def list_arguments(app, what, name, obj, options, lines):
    """Comments of Python describe an argument as "name: text", with its further lines indented: as a list."""
    old, lines[:], in_list = lines[:], [], False
    for line in old:
        argument = re.match(r"([a-z]\w*(?:, [a-z]\w*)*): (.*)", line)
        if argument:
            lines.extend([] if in_list else [""])
            lines.append(f"- **{argument.group(1)}**: {argument.group(2)}")
        elif in_list and line.startswith("    "):
            lines.append("  " + line.strip())
            continue
        else:
            lines.extend(["", line] if in_list else [line])
        in_list = bool(argument)


def setup(app):
    app.connect("source-read", add_interfaces)
    app.connect("source-read", leave_reports_out_of_the_search)
    app.connect("autodoc-process-docstring", list_arguments)
