"""Panel's server on the loopback interface, behind a random token; nothing comes from elsewhere."""

import secrets
import socket
from pathlib import Path

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
        # a message of Bokeh is several small writes: without this each waits 40 ms for the page's
        # acknowledgement of the one before; what is accepted inherits it
        for listening in self._server._http._sockets.values():
            listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.port: int = self._server.port
        self.url = f"http://localhost:{self.port}/{token}/"

    def serve(self) -> None:
        """Serve until `end`, or Ctrl-C."""
        self._server.start()
        self._server.io_loop.start()

    def end(self) -> None:
        """End serving; may be called from another thread."""
        self._server.io_loop.add_callback(self._server.io_loop.stop)
