# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens a page of pamr-quality --html in headless Chromium, from the disk, and says what is seen there."""
import base64
import contextlib
import html.parser
import json
import os
import pathlib
import select
import shutil
import signal
import subprocess
import tempfile
import time

from tool_run import at_end

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PATIENCE = 300  # seconds for an answer
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


class Browser:
    """Headless Chromium, driven through a pair of pipes (Chrome DevTools Protocol): its pages live in real time."""
    def __init__(self, *options):
        self._profile = tempfile.mkdtemp(prefix="pamr-browser-")
        read_commands, self._commands = os.pipe()
        self._answers, write_answers = os.pipe()
        command = [BROWSER, "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                   "--hide-scrollbars", "--disable-dev-shm-usage", "--disable-background-networking", "--no-first-run",
                   "--proxy-server=127.0.0.1:9", f"--user-data-dir={self._profile}", "--remote-debugging-pipe", *options]
        # It reads commands from its file 3 and writes answers to its file 4.
        self._process = subprocess.Popen(
            ["bash", "-c", f'exec "$@" 3<&{read_commands} 4>&{write_answers}', "bash", *command],
            pass_fds=(read_commands, write_answers), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, start_new_session=True,
            env=os.environ | {"HOME": self._profile, "XDG_RUNTIME_DIR": self._profile})
        os.close(read_commands)
        os.close(write_answers)
        self._n_calls, self._bytes, self._events = 0, b"", []

    def close(self):
        with contextlib.suppress(ProcessLookupError):  # it has processes of its own, which would go on without it
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        os.close(self._commands)
        os.close(self._answers)
        shutil.rmtree(self._profile, ignore_errors=True)

    def _message(self, deadline):
        while b"\0" not in self._bytes:
            ready, _, _ = select.select([self._answers], [], [], max(deadline - time.monotonic(), 0))
            assert ready, f"the browser has not answered for {PATIENCE} s"
            read = os.read(self._answers, 1 << 20)
            assert read, "the browser has ended"
            self._bytes += read
        text, self._bytes = self._bytes.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, session=None, **parameters):
        """The browser's answer to a command; what happens meanwhile is kept for `event`."""
        self._n_calls += 1
        command = {"id": self._n_calls, "method": method, "params": parameters} | ({"sessionId": session} if session else {})
        waiting = memoryview(json.dumps(command).encode() + b"\0")
        while waiting:
            waiting = waiting[os.write(self._commands, waiting):]
        deadline = time.monotonic() + PATIENCE
        while True:
            message = self._message(deadline)
            if message.get("id") == self._n_calls:
                assert "error" not in message, (method, message["error"])
                return message["result"]
            self._events.append(message)

    def event(self, method, session):
        """Waits for something to happen on a page."""
        deadline = time.monotonic() + PATIENCE
        while not any(event.get("method") == method and event.get("sessionId") == session for event in self._events):
            self._events.append(self._message(deadline))

    def complaints(self, session):
        """What scripts of a page, or the browser, have complained of."""
        said = [event["params"] for event in self._events if event.get("sessionId") == session and event.get("method") in
                ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded")]
        return [json.dumps(what) for what in said]


KEPT = {}  # the browser of this process for each set of options


def browser(*options):
    if options not in KEPT:
        KEPT[options] = at_end.enter_context(contextlib.closing(Browser(*options)))
    return KEPT[options]


class OpenPage:
    """A page of 1200 by 800 pixels; `with` closes it. `first` is a script that runs before those of the page."""
    def __init__(self, file, link="", first="", options=()):
        self._browser = browser(*options)
        self._target = self._browser.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._browser.call("Target.attachToTarget", targetId=self._target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self._call(domain + ".enable")
        self._call("Emulation.setDeviceMetricsOverride", width=1200, height=800, deviceScaleFactor=1, mobile=False)
        self._call("Page.addScriptToEvaluateOnNewDocument", source=first)
        self._call("Page.navigate", url=pathlib.Path(file).resolve().as_uri() + link)
        self._browser.event("Page.loadEventFired", self._session)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._browser.call("Target.closeTarget", targetId=self._target)

    def _call(self, method, **parameters):
        return self._browser.call(method, self._session, **parameters)

    def value(self, script):
        """Of a JavaScript expression; a promise is waited for."""
        answer = self._call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def complaints(self):
        self.value("0")  # complaints of before come before this answer
        return self._browser.complaints(self._session)

    def rest(self, may_complain=False):
        """Waits until the page has done what it was asked for. Its scripts are not to complain."""
        self.value("""new Promise((done) => {
            const root = document.documentElement, see = () => { if (root.dataset.ready) done(); };
            new MutationObserver(see).observe(root, {attributes: true});
            see();
        })""")
        self.value("page.busy.then(() => 0)")
        said = self.complaints()
        assert may_complain or not said, said
        return self

    def seen(self, **how):
        return Page(self.rest(**how).value("document.documentElement.outerHTML"))

    def screenshot(self, name):
        image = self.rest()._call("Page.captureScreenshot", format="png")["data"]
        pathlib.Path(name).write_bytes(base64.b64decode(image))
        return name

    def click(self, x, y):
        """Moves the mouse there, in pixels, presses its left button and lets it go."""
        for kind, held in (("mouseMoved", 0), ("mousePressed", 1), ("mouseReleased", 0)):
            self._call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left" if kind != "mouseMoved" else "none",
                       buttons=held, clickCount=1)

    def press(self, *keys):
        for key in keys:
            text = {"text": key} if len(key) == 1 else {}
            self._call("Input.dispatchKeyEvent", type="keyDown", key=key, **text)
            self._call("Input.dispatchKeyEvent", type="keyUp", key=key)


def opened(file, link="", **options):
    """The page after its scripts have run. They are not to complain."""
    with OpenPage(file, link, **options) as page:
        return page.seen()


def screenshot(file, link, name):
    with OpenPage(file, link) as page:
        return page.screenshot(name)
