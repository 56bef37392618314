# SPDX-License-Identifier: GPL-3.0-or-later
"""The manual as docs/build.sh makes it, opened from the disk in headless Chromium: no page complains, code has colors, and the
search shows where it found a word. Exit code 77 (skipped) where Chromium or Sphinx is missing."""
import importlib.util
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "tools"))
import report_page
from tool_run import at_end

if report_page.BROWSER is None or importlib.util.find_spec("sphinx") is None or importlib.util.find_spec("furo") is None:
    print("skipped: there is no Chromium, Sphinx or furo (scripts/setup.sh --manual)")
    sys.exit(77)

FOUND = """new Promise((done) => {
    const see = () => {
        const items = [...document.querySelectorAll("#search-results li")];
        const isReady = /found/.test((document.querySelector(".search-summary") || {}).innerText || "");
        if (isReady && items.length && items.every((item) => item.querySelector(".context") || item.querySelector("span")))
            done(items.map((item) => [item.querySelector("a").getAttribute("href"),
                                      (item.querySelector(".context") || {innerText: ""}).innerText]));
        else setTimeout(see, 50);
    };
    see();
})"""


def complaints_of_pages(manual):
    """What each page says on the console; of the pages with code, how many colors it has."""
    wrong, colors = [], {}
    for file in sorted(manual.rglob("*.html")):
        with report_page.OpenPage(file) as page:
            said = page.complaints()
            wrong += [f"{file.relative_to(manual)}: {text[:300]}" for text in said]
            if file.parent == manual / "docs":
                colors[file.name] = page.value(
                    "new Set([...document.querySelectorAll('pre span')].map((e) => getComputedStyle(e).color)).size")
    return wrong, colors


def found(manual, word):
    with report_page.OpenPage(manual / "search.html", f"?q={word}") as page:
        hits = page.value(FOUND)
        assert not page.complaints(), page.complaints()
    return hits


def main():
    with tempfile.TemporaryDirectory(prefix="pamr-manual-test-") as folder, at_end:
        manual = pathlib.Path(folder)
        subprocess.run([ROOT / "docs" / "build.sh", manual], check=True, stdout=subprocess.DEVNULL)
        wrong, colors = complaints_of_pages(manual)
        assert not wrong, "\n".join(wrong)
        assert len(colors) > 20, colors
        for name in ("building.html", "coarsening.html", "surfaces-formulas.html"):
            assert colors[name] > 2, (name, colors[name])
        for word, page in (("coarsen", "docs/coarsening.html"), ("streamlines", "docs/tools/pamr-picture.html"),
                           ("closure", "docs/closure.html")):
            hits = found(manual, word)
            texts = dict(hits)
            assert any(href.startswith(page) for href in texts), (word, list(texts))
            assert any(word in text.lower() and len(text) > 100 for href, text in hits if href.startswith(page)), (word, hits)
            assert not [href for href in texts if href.startswith(("docs/reports/", "studies/"))], (word, list(texts))


main()
