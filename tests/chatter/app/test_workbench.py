"""The workbench: views driven in process, and what its server refuses."""

from __future__ import annotations

import asyncio
import http.client
import re
import shutil
import socket
import threading
import time

import panel as pn
import pytest
from bokeh.document import Document
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

import chatter
from chatter.app.workbench.computations import Computation, Computations
from chatter.app.workbench.page import Workbench
from chatter.app.workbench.server import LARGEST_MESSAGE
from chatter.app.workbench.session import Session
from chatter.app.workbench.table_files import as_csv
from tests.chatter.app.conftest import serving
from tests.places import EXAMPLES

#: s; the first diagram may compile
PATIENCE = 300.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    found = tmp_path_factory.mktemp("work") / "cases"
    found.mkdir()
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", found / "case.toml")
    (found / "notes.toml").write_text("colour = 'red'\n", encoding="utf-8")
    (found.parent / "secret.toml").write_text("secret = 1\n", encoding="utf-8")
    return found


@pytest.fixture
def view(folder):
    page = Workbench(folder)
    stability = page.stability.diagram
    assert stability.computations.wait(PATIENCE)
    yield stability
    page.end()


def lowest(view):
    return min(depth for depth in view.limit.data["depth"] if depth == depth)


def test_only_case_files_inside_the_folder_are_offered(folder):
    (folder / "link.toml").symlink_to(EXAMPLES / "two-degrees-of-freedom" / "case.toml")
    assert Session(folder).case_names() == ["case.toml"]
    (folder / "link.toml").unlink()


def test_a_case_with_faults_is_offered_and_mended_on_the_page(tmp_path):
    """It was left out of the list without a word."""
    text = (EXAMPLES / "two-degrees-of-freedom" / "case.toml").read_text(encoding="utf-8")
    (tmp_path / "typo.toml").write_text(
        text.replace("[cut]", "[cut]\nspeeed = 3"), encoding="utf-8"
    )
    (tmp_path / "no-toml.toml").write_text(text + "\n[cut\n", encoding="utf-8")
    (tmp_path / "picture.toml").write_bytes(b"\x89PNG\xff")
    (tmp_path / "machine.toml").write_text("[body.bed]\nmas = 3\n", encoding="utf-8")
    page = Workbench(tmp_path)
    try:
        assert page.choice.options == ["no-toml.toml", "typo.toml"]
        page.choice.value = "typo.toml"
        assert page.tabs.active == list(page.views).index("Case")
        assert "speeed" in page.case.message.object
        page.case.text.value = text
        assert not page.session.problems
        page.session.save()
        assert chatter.load(tmp_path / "typo.toml").cut
        page.machine.refresh()
        assert page.machine.file.options == ["machine.toml"]
        assert "body.bed.mas" in page.machine.work.message.object
    finally:
        page.end()


def test_a_page_without_a_browser_changes_at_once_whatever_document_is_current(folder):
    pn.state.curdoc = Document()
    try:
        page = Workbench(folder)
        page.machine.work.show_message("said")
        page.end()
    finally:
        pn.state.curdoc = None
    assert page.machine.work.message.object == "said"


def test_limit_is_inverse_to_the_coefficients(view):
    before = lowest(view)
    for path in ("material.Ktc", "material.Krc"):
        slider = view.sliders[path]
        slider.value = 2.0 * slider.value
    assert view.computations.wait(PATIENCE)
    assert lowest(view) == pytest.approx(0.5 * before, rel=0.01)
    assert "--set 'material.Ktc=1200 MPa'" in view.same_call.object


def test_stable_without_limit_up_to_the_top_of_the_diagram(view):
    drawn = view.limit.data
    top = [stable for stable, d in zip(drawn["stable"], drawn["depth"], strict=True) if d != d]
    assert top
    assert set(top) == {view.sliders["lobes.depths.to"].value}


def test_the_call_shown_gives_the_limit_drawn(view, folder, monkeypatch):
    view.sliders["material.Ktc"].value = 900.0
    assert view.computations.wait(PATIENCE)
    monkeypatch.chdir(folder)
    diagram = eval(view.same_call.object.splitlines()[1], {"chatter": chatter})
    found = diagram.summary()["lowest_limit"]["critical_depth_mm"]
    assert lowest(view) == pytest.approx(found, rel=0.02)


def test_a_click_simulates_the_point(view):
    view.simulate(15500.0, 0.3)  # the lowest limit is about 1.3 mm
    assert view.computations.wait(PATIENCE)
    assert "0.3 mm: stable" in view.verdict.object
    assert len(view.motion.data["low"]) == len(view.motion.data["revolution"]) > 10


def test_a_point_off_the_diagram_is_told(view):
    view.simulate(1e9, 1.0)
    assert view.computations.wait(PATIENCE)
    assert "not a point of the diagram" in view.message.object


def test_table_holds_the_limit(view):
    rows = as_csv(view.limits()).read().splitlines()
    assert rows[0].startswith("spindle_speed [rpm],critical_depth [mm]")
    assert len(rows) == 1 + len(view.limit.data["speed"])


def test_a_crash_is_shown_and_the_next_computation_runs():
    shown, done = [], threading.Event()
    computations = Computations(shown.append)
    computations.start(Computation(lambda go_on: 1 / 0, False))
    assert computations.wait(PATIENCE)
    assert "ZeroDivisionError" in shown[0]
    computations.start(Computation(lambda go_on: done.set(), False))
    assert done.wait(PATIENCE)


def test_what_waits_for_rest_is_begun_once_nothing_newer_comes():
    """A fine diagram that began between two moves of a slider held the second one up."""
    begun = []
    computations = Computations(begun.append)
    for move in range(3):
        seen = threading.Event()
        computations.start(
            Computation(
                lambda go_on, m=move, s=seen: (begun.append(f"coarse {m}"), s.set()), False
            ),
            Computation(lambda go_on, m=move: begun.append(f"fine {m}"), True, 0.5),
        )
        assert seen.wait(PATIENCE)
    assert computations.wait(PATIENCE)
    assert begun == ["coarse 0", "coarse 1", "coarse 2", "fine 2"]


def test_what_waits_for_rest_can_be_cancelled():
    begun, seen = [], threading.Event()
    computations = Computations(begun.append)
    computations.start(
        Computation(lambda go_on: seen.set(), False),
        Computation(lambda go_on: begun.append("fine"), True, 60.0),
    )
    assert seen.wait(PATIENCE)
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and not computations.wait(0.05):
        computations.cancel()
    assert begun in ([], ["cancelled"])
    computations.end()


def test_cancel_ends_a_computation():
    shown, begun = [], threading.Event()

    def endless(go_on):
        while True:
            begun.set()
            go_on()

    computations = Computations(shown.append)
    computations.start(Computation(endless, False))
    assert begun.wait(PATIENCE)
    computations.cancel()
    assert computations.wait(PATIENCE)
    assert shown == ["cancelled"]


@pytest.fixture(scope="module")
def server(folder):
    with serving(folder) as found:
        yield found


def answer(server, path, method="GET", body=None):
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE)
    try:
        connection.request(method, path, body)
        found = connection.getresponse()
        return found.status, found.read()
    finally:
        connection.close()


def prefix(server):
    return "/" + server.url.split("/")[3]


def test_the_page_refers_to_nothing_elsewhere(server):
    status, content = answer(server, prefix(server) + "/")
    assert status == 200
    assert b"https://" not in content
    assert b"http://" not in content


def test_small_messages_leave_at_once(server):
    """Bokeh's three writes a message would each wait 40 ms for an acknowledgement."""
    accepted: list = []

    async def converse():
        page = answer(server, prefix(server) + "/")[1].decode()
        socket_of_page = await opened_socket(server, page)
        assert "ACK" in await socket_of_page.read_message()
        pages = [one._socket.ws_connection.stream for one in server._server._tornado._clients]
        accepted.extend(
            one.socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) for one in pages
        )
        socket_of_page.close()
        while await socket_of_page.read_message() is not None:
            pass

    asyncio.run(asyncio.wait_for(converse(), 30.0))
    assert accepted
    assert all(accepted)


async def opened_socket(server, page):
    """Open the websocket of a page."""
    token = re.search(r'"token":"([^"]+)"', page).group(1)
    url = f"ws://127.0.0.1:{server.port}{prefix(server)}/ws"
    request = HTTPRequest(url, headers={"Origin": server.url.rsplit("/", 2)[0]})
    return await websocket_connect(request, subprotocols=["bokeh", token])


@pytest.mark.parametrize("path", ["/", "/guess/", "/static/js/bokeh.min.js"])
def test_without_the_token_nothing_is_answered(server, path):
    status, content = answer(server, path)
    assert status == 404
    assert prefix(server).encode() not in content


@pytest.mark.parametrize("way", ["/../secret.toml", "/static/../../secret.toml",
                                 "/static/%2e%2e/%2e%2e/secret.toml", "/case.toml"])  # fmt: skip
def test_no_file_of_the_disk_is_served(server, way):
    status, content = answer(server, prefix(server) + way)
    assert status in (400, 403, 404)
    assert b"secret = 1" not in content


def test_an_oversized_upload_is_refused(server):
    try:
        status, _ = answer(server, prefix(server) + "/", "POST", b"x" * (LARGEST_MESSAGE + 1))
    except (ConnectionError, http.client.HTTPException):
        status = 400
    assert status in (400, 405, 413)
    assert answer(server, prefix(server) + "/")[0] == 200


def test_a_foreign_origin_opens_no_socket(server):
    async def connect(origin):
        url = f"ws://127.0.0.1:{server.port}{prefix(server)}/ws"
        await websocket_connect(
            HTTPRequest(url, headers={"Origin": origin}), subprotocols=["bokeh", "token"]
        )

    with pytest.raises(HTTPClientError, match="403"):
        asyncio.run(connect("http://attacker.example"))


def test_a_malformed_message_leaves_the_page_alive(server):
    page = answer(server, prefix(server) + "/")[1].decode()

    async def send():
        socket = await opened_socket(server, page)
        assert "ACK" in await socket.read_message()
        for _ in range(3):  # header, metadata, content
            await socket.write_message("{")
        while await socket.read_message() is not None:
            pass
        socket.close()
        return True  # the server has closed it

    assert asyncio.run(asyncio.wait_for(send(), 30.0))
    assert answer(server, prefix(server) + "/")[0] == 200


def test_a_notebook_shows_the_diagram_of_a_case():
    shown = chatter.explore(EXAMPLES / "two-degrees-of-freedom" / "case.toml", "zero-order")
    assert hasattr(shown, "_repr_mimebundle_")
    sliders = {one.label for one in shown.select(pn.widgets.FloatSlider)}
    assert "axial depth [mm]" in sliders
    assert shown.select(pn.pane.Bokeh)


def test_a_notebook_names_the_case_without_the_folders_of_the_computer(monkeypatch):
    place = EXAMPLES / "two-degrees-of-freedom"
    for folder, name in ((place, "case.toml"), (EXAMPLES, "two-degrees-of-freedom/case.toml")):
        monkeypatch.chdir(folder)
        shown = chatter.explore(chatter.load((place / "case.toml").resolve()), "zero-order")
        said, until = "", time.monotonic() + PATIENCE
        # the call is told after the diagram, which is computed in a thread
        while "chatter lobes" not in said and time.monotonic() < until:
            time.sleep(0.01)
            said = " ".join(str(one.object) for one in shown.select(pn.pane.Str))
        assert f"chatter lobes {name}" in said
        assert str(place) not in said


@pytest.mark.parametrize(("loaded", "wanted"), [(False, [{"inline": True}]), (True, [])])
def test_a_notebook_asks_nothing_of_the_network_and_loads_once(monkeypatch, loaded, wanted):
    asked = []

    def extension(**given):
        asked.append(given)

    extension._loaded = loaded
    monkeypatch.setattr(pn, "extension", extension)
    chatter.explore(EXAMPLES / "two-degrees-of-freedom" / "case.toml", "zero-order")
    assert asked == wanted
