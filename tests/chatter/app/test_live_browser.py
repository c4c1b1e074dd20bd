"""The page of live lobes in a real browser, driven over its debugging socket."""

from __future__ import annotations

import base64
import contextlib
import json
import os
import shutil
import socket
import struct
import subprocess
import threading
import time
import urllib.request

import pytest

import chatter
from chatter.app.live_case import LiveCase
from chatter.app.server import LiveServer
from tests.places import EXAMPLES

CASE = EXAMPLES / "two-degrees-of-freedom" / "case.toml"
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
#: s; a loaded machine starts a browser slowly
PATIENCE = 60.0

pytestmark = pytest.mark.browser


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
            time.sleep(0.02)
        raise AssertionError(f"never true: {expression}; errors: {self.value(ERRORS)}")

    def mouse(self, kind: str, x: float, y: float) -> None:
        button = {"button": "left", "clickCount": 1} if kind != "mouseMoved" else {}
        self.command("Input.dispatchMouseEvent", type=kind, x=x, y=y, **button)


ERRORS = "document.getElementById('errors').textContent"
SLIDER = "document.querySelector('input[data-path=\"{}\"]')"
FINE = "document.body.dataset.stage === 'fine'"


@pytest.fixture(scope="module")
def server():
    serving = LiveServer(LiveCase(chatter.load(CASE), "zero-order"))
    thread = threading.Thread(target=serving.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    yield serving
    serving.shutdown()
    thread.join()
    serving.end()


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    profile = tmp_path_factory.mktemp("browser")
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
        "--window-size=1280,900",
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
                pytest.fail("the browser does not start")
            time.sleep(0.05)
        yield int(told.read_text().split()[0])
    finally:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(10.0)
        process.kill()
        process.wait()


@pytest.fixture
def tab(browser, server):
    listed = f"http://127.0.0.1:{browser}/json/list"
    until = time.monotonic() + PATIENCE
    pages: list = []
    while not pages and time.monotonic() < until:
        with urllib.request.urlopen(listed, timeout=PATIENCE) as answer:
            pages = [one for one in json.load(answer) if one["type"] == "page"]
    tab = Tab(pages[0]["webSocketDebuggerUrl"])
    tab.command("Page.enable")
    tab.command("Page.navigate", url=server.url)
    tab.wait(f"document.body && location.href === '{server.url}' && {FINE}")
    yield tab
    tab.close()


def move(tab, path, place):
    tab.value(
        f"(() => {{ const s = {SLIDER.format(path)}; s.value = {place};"
        "document.body.dataset.stage = ''; s.dispatchEvent(new Event('input')); })()"
    )


def test_diagram_follows_a_slider_and_goes_back(tab):
    before = tab.value("diagram.lowest.depth_mm")
    move(tab, "material.Ktc", 1000)
    tab.wait(FINE)
    # four times the coefficient, Krc as before: the limit falls
    assert tab.value("diagram.lowest.depth_mm") < 0.5 * before
    assert tab.value("Object.keys(moved())") == ["material.Ktc"]
    tab.value("document.body.dataset.stage = ''; document.getElementById('reset').click()")
    tab.wait(FINE)
    assert tab.value("diagram.lowest.depth_mm") == before
    assert tab.value(ERRORS) == ""


def test_the_last_of_many_positions_is_shown(tab):
    for place in range(0, 1001, 50):
        move(tab, "cut.axial_depth", place)
    tab.wait(f"{FINE} && !busy")
    shown = tab.value("diagram.operating.axial_depth_mm")
    assert shown == pytest.approx(tab.value("values['cut.axial_depth']"))
    # the slider goes to eight times the 2.5 mm of the case
    assert shown == pytest.approx(20.0)


def on_diagram(tab, rpm, depth):
    return tab.value(
        "(() => { const r = document.getElementById('lobes').getBoundingClientRect();"
        f"return [r.left + plot.x({rpm}), r.top + plot.y({depth})]; }})()"
    )


def test_hover_tells_speed_depth_and_chatter_frequency(tab):
    x, y = on_diagram(tab, 15000.0, 5.0)
    tab.mouse("mouseMoved", x, y)
    told = tab.wait("!document.getElementById('tip').hidden && "
                    "document.getElementById('tip').textContent")  # fmt: skip
    assert "rpm" in told
    assert "mm" in told
    assert "chatter frequency" in told


def test_click_simulates(tab):
    x, y = on_diagram(tab, 15500.0, 0.3)
    tab.mouse("mouseMoved", x, y)
    tab.mouse("mousePressed", x, y)
    tab.mouse("mouseReleased", x, y)
    told = tab.wait("document.body.dataset.simulated")
    assert told.startswith("Simulated: stable")
    assert tab.value("document.getElementById('motion').clientHeight") > 100


def test_pixels_of_the_diagram_tell_stable_from_chatter(tab):
    colour = (
        "[...(() => {{ const c = document.getElementById('lobes'), k = c.width / c.clientWidth;"
        "return c.getContext('2d').getImageData(plot.x({0}) * k, plot.y({1}) * k, 1, 1).data;"
        "}})()]"
    )
    # away from the lines of the grid
    stable = tab.value(colour.format(15630.0, 0.13))[:3]
    unstable = tab.value(colour.format(15630.0, 9.87))[:3]
    assert stable == [0xE8, 0xF3, 0xEE]
    assert unstable == [0xF6, 0xE3, 0xD8]


def test_a_wrong_value_is_told_in_the_page(tab):
    # a range of speeds whose lowest is the highest
    tab.value("set(sliders[0], sliders[0].high); set(sliders[1], sliders[1].low)")
    assert "not below" in tab.wait(ERRORS)
    tab.value("document.body.dataset.stage = ''; document.getElementById('reset').click()")
    tab.wait(FINE)
    assert tab.value(ERRORS) == ""


def test_saving_downloads_the_case(tab, tmp_path):
    tab.command("Page.setDownloadBehavior", behavior="allow", downloadPath=str(tmp_path))
    move(tab, "tool.teeth", 4)
    tab.wait(FINE)
    tab.value("document.getElementById('save').click()")
    until = time.monotonic() + PATIENCE
    saved = tmp_path / "case.toml"
    while not saved.is_file() and time.monotonic() < until:
        time.sleep(0.05)
    assert chatter.load(saved).tool.teeth == 4
