# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual: Sphinx on the Markdown pages as they lie in the project, which code-hosting sites show as well.

The pages have no directives. What a site needs beyond them is added while they are read:
- docs/index.md and docs/reports/index.md list the pages under headings; these lists become the tables of contents at the side.
- docs/reports and studies are a book of their own, which the search leaves out.
- docs/api/cpp.md names namespaces and headers (docs/build.sh gives those headers to Doxygen); what they declare follows each namespace.
- docs/api/python.md names modules, likewise.
- Blocks of code without a language get the one that their first lines look like.
- Debian's furo has a script that imports another, which browsers allow in modules only, and those from a server only, and a style
  that imports one from a server's folder: each becomes one file, and no script is a module.
- Browsers do not let the search read other pages from a disk: it has their texts in a script of its own.
"""
import json
import os
import pathlib
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
MODULE_SCRIPT = '<script type="module"'
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


LANGUAGES = (("toml", r"\[{1,2}[\w.]+\]\s*(?:#|$)|[\w.]+ = (?:[\"\[\d-]|true|false)"),
             ("cpp", r"#include|(?:const )?auto |using |namespace |\w+::|//"),
             ("python", r"import |from \w+ import |def |with .*:$|for .*:$|\w+ = \w+[.(]"),
             ("sh", r"#|\$ |pamr-\w+ |[\w./-]+\.(?:sh|py)\b|(?:\.ci/run|apt-get|cd|chrt|cmake|ctest|export|git|grep|ls|mpirun|python3|sudo) |[A-Z]+="))


def color_code(app, doctree):
    for block in doctree.findall(lambda node: node.tagname == "literal_block" and node.get("language", "none") in ("none", "default")):
        first = next(filter(None, map(str.strip, block.astext().splitlines())), "")
        block["language"] = next((name for name, begin in LANGUAGES if re.match(begin, first)), "none")


def add_texts_to_the_search(app, pagename, templatename, context, doctree):
    if pagename == "search":
        app.add_js_file("search_texts.js")


def join_files_of_the_theme(static):
    furo, gumshoe, style = static / "scripts" / "furo.js", static / "scripts" / "gumshoe-patched.js", static / "styles" / "furo.css"
    text = re.sub(r"^import (?:\* as )?\w+ from .*\n", "", furo.read_text(encoding="utf-8"), count=1)
    if gumshoe.exists():
        furo.write_text(gumshoe.read_text(encoding="utf-8") + text, encoding="utf-8")
    text = style.read_text(encoding="utf-8")
    style.write_text(re.sub(r"@import url\((/javascript/[^)]*)\);", lambda m: pathlib.Path("/usr/share" + m[1]).read_text(encoding="utf-8"),
                            text), encoding="utf-8")
    for page in static.parent.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        if MODULE_SCRIPT in text:
            page.write_text(text.replace(MODULE_SCRIPT, "<script defer"), encoding="utf-8")


def finish(app, error):
    if error or app.builder.name != "html":
        return
    out, texts = pathlib.Path(app.outdir), {}
    join_files_of_the_theme(out / "_static")
    for name in sorted(app.env.all_docs):
        if "nosearch" not in app.env.metadata.get(name, {}):
            page = (out / (name + ".html")).read_text(encoding="utf-8")
            main = re.search(r'<article role="main"[^>]*>(.*?)</article>', page, re.S).group(1)
            code = re.findall(r"<pre>.*?</pre>", main, re.S)  # behind the sentences; the title is shown in any case
            main = re.sub(r'<h1>.*?</h1>|<pre>.*?</pre>|<a class="headerlink".*?</a>', "", main, flags=re.S) + " ".join(code)
            texts[f"./{name}.html"] = " ".join(re.sub(r"<[^>]*>", "", main).split())
    script = ("// Texts of the pages as HTML, for excerpts of the search.\n"
              f"const TEXTS = {json.dumps(texts, ensure_ascii=False)};\n"
              "const page = (text) => ({text: async () => `<div role=\"main\">${text}</div>`});\n"
              "window.fetch = async (url) => page(TEXTS[url] || \"\");\n")
    (out / "_static" / "search_texts.js").write_text(script, encoding="utf-8")


def setup(app):
    app.connect("doctree-read", color_code)
    app.connect("html-page-context", add_texts_to_the_search)
    app.connect("build-finished", finish)
    app.connect("source-read", add_interfaces)
    app.connect("source-read", leave_reports_out_of_the_search)
    app.connect("autodoc-process-docstring", list_arguments)
