"""A tab of headless chromium, driven over its debugging socket."""

from __future__ import annotations

import base64
import contextlib
import json
import os
import shutil
import socket
import struct
import subprocess
import time
import urllib.request
from pathlib import Path

import numpy as np
from PIL import Image

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
#: of the mouse's modifiers
SHIFT = 8
#: s; a loaded machine starts a browser slowly
PATIENCE = 90.0
#: finds elements behind shadow roots too
DEEP = """
window.deepAll = (selector, root = document) => {
  const found = [...root.querySelectorAll(selector)];
  for (const one of root.querySelectorAll('*'))
    if (one.shadowRoot) found.push(...deepAll(selector, one.shadowRoot));
  return found;
};
window.labelled = (text, selector = 'button') =>
  deepAll(selector).find(one => one.textContent.trim() === text && one.getClientRects().length);
window.boxLabelled = text => deepAll('input[type=checkbox]').find(one =>
  one.getClientRects().length && one.nextElementSibling
  && one.nextElementSibling.textContent.trim() === text);
window.pageText = () => {
  const texts = [];
  const walk = root => { for (const one of root.childNodes) {
    if (one.nodeType === 3) texts.push(one.textContent);
    if (one.nodeType === 1 && !['STYLE', 'SCRIPT'].includes(one.tagName)) {
      if (one.shadowRoot) walk(one.shadowRoot);
      walk(one);
    } } };
  walk(document.body);
  return texts.join(' ');
};
"""


class Tab:
    """A tab of the browser: the few commands of its debugging protocol that are needed."""

    def __init__(self, address: str) -> None:
        host, port, path = address.removeprefix("ws://").replace("/", ":", 1).split(":", 2)
        self._socket = socket.create_connection((host, int(port)), timeout=PATIENCE)
        key = base64.b64encode(os.urandom(16)).decode()
        self._socket.sendall(
            f"GET /{path} HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
            "Sec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        while self._line().strip():
            pass
        self._count = 0

    def close(self) -> None:
        self._socket.close()

    def _line(self) -> bytes:
        line = b""
        while not line.endswith(b"\n"):
            line += self._exactly(1)
        return line

    def _exactly(self, count: int) -> bytes:
        found = b""
        while len(found) < count:
            part = self._socket.recv(count - len(found))
            assert part, "the browser has gone"
            found += part
        return found

    def command(self, method: str, **given) -> dict:
        self._count += 1
        text = json.dumps({"id": self._count, "method": method, "params": given}).encode()
        # a frame of text, masked with zeros
        length = bytes([0x80 | 126]) + struct.pack(">H", len(text))
        self._socket.sendall(b"\x81" + length + bytes(4) + text)
        while True:
            told = json.loads(self._message())
            if told.get("id") == self._count:
                assert "error" not in told, told
                return told["result"]

    def _message(self) -> bytes:
        message, last = b"", False
        while not last:
            first, length = self._exactly(2)
            last = bool(first & 0x80)
            if length == 126:
                length = struct.unpack(">H", self._exactly(2))[0]
            elif length == 127:
                length = struct.unpack(">Q", self._exactly(8))[0]
            message += self._exactly(length)
        return message

    def value(self, expression: str):
        """Value of an expression in the page."""
        found = self.command(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def wait(self, expression: str):
        """Value of an expression once it is true."""
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            found = self.value(expression)
            if found:
                return found
            time.sleep(0.05)
        raise AssertionError(f"never true: {expression}; page: {self.value('pageText()')[:3000]}")

    def mouse(self, kind: str, x: float, y: float, keys: int = 0) -> None:
        button = {"button": "left", "clickCount": 1} if kind != "mouseMoved" else {}
        self.command("Input.dispatchMouseEvent", type=kind, x=x, y=y, modifiers=keys, **button)

    def screenshot(self, path: Path) -> None:
        """Write a picture of the page."""
        shot = self.command("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(shot["data"]))

    def settled_screenshot(self, path: Path) -> None:
        """Write a picture of the page once it no longer changes."""
        before, until = b"", time.monotonic() + PATIENCE
        while time.monotonic() < until:
            time.sleep(0.7)
            self.screenshot(path)
            if path.read_bytes() == before:
                return
            before = path.read_bytes()

    def open(self, url: str) -> None:
        """Go to a page and wait until Bokeh has drawn it."""
        self.command("Page.enable")
        self.command("Page.navigate", url=url)
        self.wait(
            f"document.body && location.href === '{url}' && document.readyState === 'complete'"
        )
        self.value(DEEP)
        self.wait("window.Bokeh && Bokeh.documents.length && deepAll('.bk-tab, button').length")

    def click_on(self, text: str, selector: str = "button") -> None:
        """Click the visible element of a text."""
        element = f"labelled({json.dumps(text)}, {json.dumps(selector)})"
        # the page may still move: wait until the place stays, then press the mouse there
        before = None
        while True:
            self.wait(f"!!{element} && !{element}.disabled")
            place = self.value(
                f"(() => {{ const one = {element}; one.scrollIntoView({{block: 'center'}});"
                "const r = one.getBoundingClientRect();"
                "return [r.left + r.width / 2, r.top + r.height / 2]; })()"
            )
            if place == before:
                break
            before = place
            time.sleep(0.2)
        self.click(*place)

    def click(self, x: float, y: float, keys: int = 0) -> None:
        """Click a place of the window; `keys` are those held, as SHIFT."""
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.mouse(kind, x, y, keys)

    def tick(self, label: str) -> None:
        """Click the visible box of a label."""
        box = f"boxLabelled({json.dumps(label)})"
        self.wait(f"!!{box}")
        self.value(f"{box}.click()")

    def _field(self, label: str, selector: str) -> str:
        """Expression of the visible field of a label, once it is there."""
        field = (
            "(() => { const wanted = " + json.dumps(label) + ";"
            f"for (const one of deepAll({json.dumps(selector)})) {{"
            "  if (!one.getClientRects().length) continue;"
            "  const group = one.closest('.bk-input-group');"
            "  const told = group && group.querySelector('label');"
            "  if (told && told.textContent.trim() === wanted) return one; } })()"
        )
        self.wait(f"!!{field}")
        return field

    def type_into(self, label: str, text: str) -> None:
        """Type a text into the visible field of a label and leave it."""
        field = self._field(label, "input, textarea")
        self.value(
            f"(() => {{ const one = {field}; one.focus(); one.value = {json.dumps(text)};"
            "one.dispatchEvent(new Event('input', {bubbles: true}));"
            "one.dispatchEvent(new Event('change', {bubbles: true})); one.blur(); })()"
        )

    def choose(self, label: str, option: str) -> None:
        """Choose an option of the visible list of a label; of a list of several, one more."""
        field = self._field(label, "select")
        self.value(
            f"(() => {{ const one = {field}; const wanted = {json.dumps(option)};"
            "[...one.options].find(o => o.textContent.trim() === wanted).selected = true;"
            "one.dispatchEvent(new Event('change', {bubbles: true})); })()"
        )

    def upload(self, files: list[Path], which: int = 0) -> None:
        """Give files to the visible file input."""
        self.wait(f"deepAll('input[type=file]').length > {which}")
        found = self.command("Runtime.evaluate", expression=f"deepAll('input[type=file]')[{which}]")
        self.command(
            "DOM.setFileInputFiles",
            files=[str(path) for path in files],
            objectId=found["result"]["objectId"],
        )

    def wait_for_text(self, text: str) -> None:
        """Wait until the page shows a text."""
        self.wait(f"pageText().includes({json.dumps(text)})")


@contextlib.contextmanager
def browser(profile: Path):
    """Run the browser with a profile of its own; yields the port of its debugging socket."""
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-quic",
        "--no-first-run",
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--disable-dev-shm-usage",
        "--window-size=1500,1200",
        "--remote-debugging-port=0",
    ]
    process = subprocess.Popen(
        [BROWSER, *options, f"--user-data-dir={profile}", "about:blank"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "HOME": str(profile)},
    )
    try:
        told = profile / "DevToolsActivePort"
        until = time.monotonic() + PATIENCE
        while not (told.is_file() and told.read_text().strip()):
            if process.poll() is not None or time.monotonic() > until:
                raise AssertionError("the browser does not start")
            time.sleep(0.05)
        yield int(told.read_text().split()[0])
    finally:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(10.0)
        process.kill()
        process.wait()


def tab_of(port: int) -> Tab:
    """Connect to the first page of the browser."""
    pages: list = []
    until = time.monotonic() + PATIENCE
    while not pages and time.monotonic() < until:
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=PATIENCE) as told:
            pages = [one for one in json.load(told) if one["type"] == "page"]
    return Tab(pages[0]["webSocketDebuggerUrl"])


def shot(tab, folder, name):
    """Look at the page: a picture that is not one colour, and no error on it."""
    path = folder / f"{name}.png"
    tab.settled_screenshot(path)
    colours = np.asarray(Image.open(path).convert("L"))
    assert len(np.unique(colours)) > 20
    assert "Traceback" not in tab.value("pageText()")
