"""HTTP server of the page: loopback only, a random token in the path, the Host header checked."""

import hmac
import json
import os
import secrets
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from typing import Any
from urllib.parse import urlsplit

from chatter.app.live_case import STAGES, LiveCase
from chatter.app.newest_request import NewestRequest, SupersededError
from chatter.description.errors import InputError, RunError

ADDRESS = "127.0.0.1"
#: bytes of a request
LARGEST_REQUEST = 64 * 1024
#: s, for a request to arrive
_PATIENCE = 15.0
_LONGEST_DIAGRAM, _LONGEST_SIMULATION = 60.0, 60.0
_LONGEST_PAGE_NAME = 40

_PAGE = {
    "": ("index.html", "text/html; charset=utf-8"),
    "live.css": ("live.css", "text/css; charset=utf-8"),
    "live.js": ("live.js", "text/javascript; charset=utf-8"),
    "draw.js": ("draw.js", "text/javascript; charset=utf-8"),
}
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class _RefusedError(Exception):
    """A request that is not answered."""

    def __init__(self, status: HTTPStatus, text: str) -> None:
        super().__init__(text)
        self.status = status


class LiveServer(ThreadingHTTPServer):
    """Server of the page of one case; port 0 takes a free one, InputError if it cannot be had."""

    daemon_threads = True
    block_on_close = False
    # elsewhere it would let another process take over the port of a page that is shown
    allow_reuse_address = os.name == "posix"

    def __init__(self, live: LiveCase, port: int = 0) -> None:
        try:
            super().__init__((ADDRESS, port), _Handler)
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            raise InputError(f"--port {port}: cannot be served on ({reason})") from None
        self.live = live
        self.token = secrets.token_urlsafe(24)
        self.diagrams = NewestRequest(_LONGEST_DIAGRAM)
        self.simulations = NewestRequest(_LONGEST_SIMULATION)

    @property
    def url(self) -> str:
        """Address of the page, with its token."""
        return f"http://{ADDRESS}:{self.server_port}/{self.token}/"

    def hosts(self) -> tuple[str, ...]:
        """Names by which a browser may call; any other is a foreign page's."""
        return tuple(f"{name}:{self.server_port}" for name in (ADDRESS, "localhost"))

    def end(self) -> None:
        """Give up what is computed and close the socket; `serve_forever` has returned."""
        self.diagrams.end()
        self.simulations.end()
        self.server_close()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of connections that the browser drops."""


class _Handler(BaseHTTPRequestHandler):
    server: LiveServer
    timeout = _PATIENCE
    server_version, sys_version = "chatter", ""

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002  (name of the base class)
        """Keep the terminal quiet."""

    def do_GET(self) -> None:
        """Answer with a file of the page, or with its sliders."""
        self._answer(self._get)

    def do_POST(self) -> None:
        """Answer with a diagram, a simulated point or a case."""
        self._answer(self._post)

    def _answer(self, make: Callable[[str], tuple[bytes, str]]) -> None:
        try:
            body, kind = make(self._path())
            self._send(HTTPStatus.OK, body, kind)
        except _RefusedError as error:
            self._send_errors(error.status, [str(error)])
        except SupersededError:
            self._send_errors(HTTPStatus.CONFLICT, ["a newer request has come"])
        except InputError as error:
            self._send_errors(HTTPStatus.UNPROCESSABLE_ENTITY, list(error.messages))
        except RunError as error:
            self._send_errors(HTTPStatus.UNPROCESSABLE_ENTITY, [str(error)])
        except (ConnectionError, TimeoutError):
            self.close_connection = True
        except Exception as error:
            text = f"a fault in chatter itself ({type(error).__name__}: {error})"
            self._send_errors(HTTPStatus.INTERNAL_SERVER_ERROR, [text])

    def _path(self) -> str:
        """Path behind the token; raises where host, origin or token are wrong."""
        if self.headers.get("Host") not in self.server.hosts():
            raise _RefusedError(HTTPStatus.FORBIDDEN, "this page is served to this machine alone")
        origin = self.headers.get("Origin")
        if origin is not None and urlsplit(origin).netloc not in self.server.hosts():
            raise _RefusedError(HTTPStatus.FORBIDDEN, "another page may not ask this one")
        token, slash, path = self.path.removeprefix("/").partition("/")
        given = token.encode("utf-8", "surrogateescape")
        if not slash or not hmac.compare_digest(given, self.server.token.encode()):
            raise _RefusedError(HTTPStatus.FORBIDDEN, "the address of the page has a token")
        return path

    def _get(self, path: str) -> tuple[bytes, str]:
        if path == "setup":
            return _as_json(self.server.live.setup())
        if path not in _PAGE:
            raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")
        name, kind = _PAGE[path]
        return (files("chatter.app") / "page" / name).read_bytes(), kind

    def _post(self, path: str) -> tuple[bytes, str]:
        known = {"diagram": self._diagram, "simulation": self._simulation, "case": self._case}
        if path not in known:
            raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no such page")
        return known[path](self._request())

    def _request(self) -> dict[str, Any]:
        if self.headers.get_content_type() != "application/json":
            raise _RefusedError(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "JSON is required")
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit()):
            raise _RefusedError(HTTPStatus.LENGTH_REQUIRED, "the length of the request is required")
        if len(length) > 9 or int(length) > LARGEST_REQUEST:
            raise _RefusedError(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {LARGEST_REQUEST} bytes are allowed"
            )
        try:
            given = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "the request is not JSON") from None
        if not isinstance(given, dict):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "the request is not a table")
        return given

    def _diagram(self, given: dict[str, Any]) -> tuple[bytes, str]:
        stage = given.get("stage")
        if not isinstance(stage, str) or stage not in STAGES:
            raise _RefusedError(HTTPStatus.BAD_REQUEST, f"stage: {' or '.join(STAGES)} is required")
        live, values = self.server.live, given.get("values")
        return _as_json(
            self.server.diagrams.run(
                _page_of(given), lambda go_on: live.diagram(values, stage, go_on)
            )
        )

    def _simulation(self, given: dict[str, Any]) -> tuple[bytes, str]:
        live, values = self.server.live, given.get("values")
        point = given.get("spindle_speed_rpm"), given.get("axial_depth_mm")
        return _as_json(
            self.server.simulations.run(
                _page_of(given), lambda go_on: live.simulation(values, *point, go_on)
            )
        )

    def _case(self, given: dict[str, Any]) -> tuple[bytes, str]:
        text = self.server.live.case_text(given.get("values"))
        return text.encode(), "application/toml; charset=utf-8"

    def _send(self, status: HTTPStatus, body: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def _send_errors(self, status: HTTPStatus, messages: list[str]) -> None:
        # what remains of the request is not read
        self.close_connection = True
        try:
            self._send(status, *_as_json({"errors": messages}))
        except OSError:
            # the browser has gone
            return


def _page_of(given: dict[str, Any]) -> str:
    """Name that a page gives itself, so that its newest request is told from another page's."""
    name = given.get("page", "")
    if not isinstance(name, str) or len(name) > _LONGEST_PAGE_NAME:
        raise _RefusedError(HTTPStatus.BAD_REQUEST, "page: a short name is required")
    return name


def _as_json(content: dict[str, Any]) -> tuple[bytes, str]:
    return json.dumps(content, allow_nan=False).encode(), "application/json"
