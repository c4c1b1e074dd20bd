"""Panel's server on the loopback interface, behind a random token; nothing comes from elsewhere."""

import secrets
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn

from chatter.app.workbench.page import Workbench
from chatter.description.errors import InputError

ADDRESS = "127.0.0.1"
#: bytes of a message or a request
LARGEST_MESSAGE = 1024 * 1024


class WorkbenchServer:
    """Server of a folder; port 0 takes a free one, InputError if the port cannot be had.

    `first` is the case that is open at first, `text` what it holds where that differs from its
    file, `method` that of its diagram.

    Every address begins with the token; a socket is opened only for pages of this server.
    """

    def __init__(
        self,
        folder: Path,
        first: str | None = None,
        port: int = 0,
        method: str | None = None,
        text: str | None = None,
    ) -> None:
        pn.extension("filedropper")
        token = secrets.token_urlsafe(24)

        def page() -> pn.viewable.Viewable:
            session = Workbench(folder, first, method, text, pn.state.curdoc)
            pn.state.on_session_destroyed(lambda _: session.end())
            return session.__panel__()

        try:
            self._server = pn.io.server.get_server(
                {"/": page},
                port=port,
                address=ADDRESS,
                title="chatter",
                prefix=f"/{token}",
                websocket_max_message_size=LARGEST_MESSAGE,
                http_server_kwargs={"max_body_size": LARGEST_MESSAGE},
            )
        except OSError as error:
            raise InputError(f"--port {port} cannot be used: {error.strerror}") from None
        self._server._http.handle_stream = _undelayed(self._server._http.handle_stream)
        self.port: int = self._server.port
        self.url = f"http://localhost:{self.port}/{token}/"

    def serve(self) -> None:
        """Serve until `end`, or Ctrl-C."""
        self._server.start()
        self._server.io_loop.start()

    def end(self) -> None:
        """End serving; may be called from another thread."""
        self._server.io_loop.add_callback(self._server.io_loop.stop)


def _undelayed(handle_stream: Callable[[Any, Any], None]) -> Callable[[Any, Any], None]:
    """Handler of new connections, all writes to which leave at once.

    A message of Bokeh is several small writes: with Nagle's algorithm each waits up to 40 ms for
    the page's acknowledgement of the one before. Tornado turns it on again after each answer.
    """

    def handle(stream: Any, address: Any) -> None:
        stream.set_nodelay(True)
        stream.set_nodelay = lambda _: None
        handle_stream(stream, address)

    return handle
