"""Requests that no page of ours sends: each is refused, and the page beside it lives on."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import shutil
import socket
import struct
from types import SimpleNamespace

import pytest
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from chatter.app.workbench.server import LARGEST_MESSAGE
from chatter.app.workbench.session import Session
from chatter.app.workbench.upload import dropper
from chatter.description.errors import InputError
from tests.chatter.app.conftest import serving
from tests.chatter.app.test_workbench import answer, opened_socket, prefix
from tests.places import EXAMPLES

PATIENCE = 60.0


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    folder = tmp_path_factory.mktemp("work") / "cases"
    folder.mkdir()
    shutil.copy(EXAMPLES / "two-degrees-of-freedom" / "case.toml", folder / "case.toml")
    with serving(folder) as found:
        yield found


async def send(page, kind, content):
    await page.write_message(json.dumps({"msgid": "1", "msgtype": kind}))
    await page.write_message("{}")
    await page.write_message(content if isinstance(content, str) else json.dumps(content))


async def reply(page, kind):
    """Wait for a message of a kind; False where the socket is closed first."""
    while (text := await page.read_message()) is not None:
        if isinstance(text, str) and f'"{kind}"' in text:
            return True
    return False


async def ended(page):
    """Read a socket to its end, which is told once."""
    while await page.read_message() is not None:
        pass


async def hang_up(page):
    """Close a socket and wait for its end: the loop that ends first would leave it open.

    Where the server has closed it the end may have been read already.
    """
    page.close()
    with contextlib.suppress(asyncio.TimeoutError):
        await asyncio.wait_for(ended(page), 1.0)


def conversation(server, hostile):
    """Open a page and another socket that is hostile; the first must still answer after it."""

    async def run():
        html = answer(server, prefix(server) + "/")[1].decode()
        page = await opened_socket(server, html)
        other = await opened_socket(server, answer(server, prefix(server) + "/")[1].decode())
        try:
            await hostile(other)
        finally:
            await hang_up(other)
        await send(page, "PULL-DOC-REQ", {})
        lives = await reply(page, "PULL-DOC-REPLY")
        await hang_up(page)
        return lives

    assert asyncio.run(asyncio.wait_for(run(), PATIENCE))
    assert answer(server, prefix(server) + "/")[0] == 200


def change(model, **attributes):
    return {"kind": "ModelChanged", "model": {"id": model}, **attributes}


DEEP = "[" * 20_000 + "]" * 20_000
MESSAGES = {
    "unknown type": ("RUN-CODE", {"code": "1"}),
    "no object": ("PATCH-DOC", []),
    "no events": ("PATCH-DOC", {}),
    "model that is not there": (
        "PATCH-DOC", {"events": [change("p99999999", attr="value", new=1)]},
    ),
    "unknown class": (
        "PATCH-DOC",
        {"events": [{"kind": "RootAdded",
                     "model": {"type": "object", "name": "os.system", "id": "x"}}]},
    ),
    "unknown event": ("PATCH-DOC", {"events": [{"kind": "Execute", "code": "import os"}]}),
    "without end inside": ("PATCH-DOC", DEEP),
    "not JSON": ("PATCH-DOC", "\x00\xff"),
    "not a number": ("PATCH-DOC", '{"events": NaN}'),
    "a document of another": ("PUSH-DOC", {"doc": {"roots": [], "title": "x", "version": "0"}}),
}  # fmt: skip


@pytest.mark.parametrize("name", MESSAGES)
def test_a_message_of_no_page_is_answered_by_an_error_and_the_page_lives(server, name):
    async def hostile(other):
        await reply(other, "ACK")
        await send(other, *MESSAGES[name])
        await asyncio.wait_for(reply(other, "ERROR"), PATIENCE)

    if name == "a document of another":

        async def hostile(other):
            await reply(other, "ACK")
            await send(other, *MESSAGES[name])

    conversation(server, hostile)


def test_a_message_beyond_its_bound_closes_its_socket(server):
    async def hostile(other):
        await reply(other, "ACK")
        await other.write_message("x" * (LARGEST_MESSAGE + 1))
        await ended(other)

    conversation(server, hostile)


def test_frames_of_no_websocket_end_their_connection(server):
    """After a lawful handshake: a frame that claims 2^62 bytes, and one with reserved bits."""
    html = answer(server, prefix(server) + "/")[1].decode()
    token = html.split('"token":"')[1].split('"')[0]
    for frame in (struct.pack(">BBQ", 0x81, 0xFF, 2**62) + bytes(4), b"\xf3\x80" + bytes(4)):
        with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as line:
            key = base64.b64encode(bytes(16)).decode()
            origin = server.url.rsplit("/", 2)[0]
            line.sendall(
                f"GET {prefix(server)}/ws HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n"
                f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
                f"Sec-WebSocket-Version: 13\r\nOrigin: {origin}\r\n"
                f"Sec-WebSocket-Protocol: bokeh, {token}\r\n\r\n".encode()
            )
            assert b"101" in line.recv(100)
            line.sendall(frame)
            while line.recv(65536):
                pass
    assert answer(server, prefix(server) + "/")[0] == 200


@pytest.mark.parametrize("token", ["", "token", "a.b.c", "x" * 5000])
def test_a_session_without_a_token_of_this_server_is_refused(server, token):
    async def connect():
        url = f"ws://127.0.0.1:{server.port}{prefix(server)}/ws"
        origin = {"Origin": server.url.rsplit("/", 2)[0]}
        page = await websocket_connect(
            HTTPRequest(url, headers=origin), subprotocols=["bokeh", token]
        )
        told = await page.read_message()
        page.close()
        return told

    try:
        told = asyncio.run(asyncio.wait_for(connect(), PATIENCE))
    except (HTTPClientError, OSError):
        told = None
    assert told is None
    assert answer(server, prefix(server) + "/")[0] == 200


@pytest.mark.parametrize("method", ["PUT", "DELETE", "PATCH", "OPTIONS", "TRACE"])
def test_methods_that_no_page_uses_are_refused(server, method):
    assert answer(server, prefix(server) + "/", method)[0] in (403, 405)
    assert answer(server, prefix(server) + "/")[0] == 200


def test_headers_beyond_their_bound_and_no_http_end_their_connection(server):
    for words in (b"GET / HTTP/1.1\r\nX: " + b"x" * 200_000 + b"\r\n\r\n", b"\x16\x03\x01\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", server.port), timeout=PATIENCE) as line:
            try:
                line.sendall(words)
                content = line.recv(65536)
            except ConnectionError:
                content = b""
            assert b"200 OK" not in content
    assert answer(server, prefix(server) + "/")[0] == 200


PARTS = [
    {"name": "../x.csv", "chunk": 1, "total_chunks": 1, "data": b"1"},
    {"name": 7, "chunk": 1, "total_chunks": 1, "data": b"1"},
    {"name": "a.csv", "chunk": 1, "total_chunks": 1, "data": "text"},
    {"name": "a.csv", "chunk": 7, "total_chunks": 1, "data": b"1"},
    {"name": "a.csv", "chunk": None, "total_chunks": None, "data": b"1"},
    {},
]


@pytest.mark.parametrize("part", PARTS, ids=str)
def test_parts_of_an_upload_that_lie_leave_no_file(part, tmp_path):
    session, stored = Session(tmp_path / "inside"), []

    def take(files):
        with contextlib.suppress(InputError):
            stored.append(session.store("taps", files, (".csv",)))

    widget = dropper(take, "files")
    event = SimpleNamespace(event_name="upload_event", data={"type": "text/csv", **part})
    widget._process_event(event)
    assert not stored
    assert not list(tmp_path.rglob("*.csv"))
    # a proper one is still taken
    proper = {"name": "good.csv", "chunk": 1, "total_chunks": 1, "data": b"1,2\n",
              "type": "text/csv"}  # fmt: skip
    widget.forget()
    widget._process_event(SimpleNamespace(event_name="upload_event", data=proper))
    assert [path.name for path in tmp_path.rglob("*.csv")] == ["good.csv"]
