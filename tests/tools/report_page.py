# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a page of pamr-quality --html in headless Chromium, from the disk, and says what is seen there."""
import contextlib
import html.parser
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
VOID = {"meta", "link", "input", "br", "hr", "img"}


class Page(html.parser.HTMLParser):
    """Tables by their caption, as lists of rows of texts, and the texts of elements with an id."""
    def __init__(self, text):
        super().__init__()
        self.tables, self.by_id, self.root = {}, {}, {}
        self._stack, self._rows, self._cell, self._caption = [], None, None, None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "html":
            self.root = attributes
        if tag not in VOID:
            self._stack.append((tag, attributes.get("id")))
        if "id" in attributes:
            self.by_id.setdefault(attributes["id"], [])
        if tag == "table":
            self._rows, self._caption = [], ""
        elif tag == "tr" and self._rows is not None:
            self._rows.append([])
        elif tag in ("td", "th"):
            self._cell = ""

    def handle_data(self, data):
        if self._stack and self._stack[-1][0] in ("script", "style"):
            return
        if self._cell is not None:
            self._cell += data
        elif self._stack and self._stack[-1][0] == "caption":
            self._caption += data
        for _, name in self._stack:
            if name and data.strip():
                self.by_id[name].append(data.strip())

    def handle_endtag(self, tag):
        if tag in ("td", "th") and self._cell is not None:
            self._rows[-1].append(self._cell)
            self._cell = None
        elif tag == "table":
            self.tables[self._caption] = self._rows
            self._rows = None
        while self._stack and self._stack[-1][0] != tag:
            self._stack.pop()
        if self._stack:
            self._stack.pop()

    def picked(self):
        """What was picked: its title, and its numbers by name."""
        title, *lines = self.by_id["picked"]
        return title, dict(zip(lines[::2], lines[1::2]))


def browse(page, link="", *options):
    """Runs the browser on the page until its scripts have come to rest; its output and what was said on the console."""
    with tempfile.TemporaryDirectory(prefix="pamr-browser-") as profile:
        command = [BROWSER, "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                   "--hide-scrollbars", "--disable-dev-shm-usage", "--disable-background-networking", "--no-first-run",
                   "--proxy-server=127.0.0.1:9", f"--user-data-dir={profile}", "--enable-logging=stderr",
                   "--window-size=1200,800", "--virtual-time-budget=20000", *options,
                   pathlib.Path(page).resolve().as_uri() + link]
        browser = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                                   env=os.environ | {"HOME": profile, "XDG_RUNTIME_DIR": profile})
        try:
            out, err = browser.communicate(timeout=150)
        finally:  # it has processes of its own, which would go on without it
            with contextlib.suppress(ProcessLookupError):
                os.killpg(browser.pid, signal.SIGKILL)
    return out, [line for line in err.splitlines() if re.search(r"\bCONSOLE\b", line)]


def opened(page, link=""):
    """The page after its scripts have run. They are not to complain."""
    text, said = browse(page, link, "--dump-dom")
    assert not said, said
    result = Page(text)
    assert result.root.get("data-ready") == "yes", (result.root, text[:500])
    return result


def screenshot(page, link, name):
    _, said = browse(page, link, f"--screenshot={pathlib.Path(name).resolve()}")
    assert not said, said
    return name
