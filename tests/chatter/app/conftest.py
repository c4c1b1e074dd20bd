"""A workbench in process, a served folder, and a tab of a browser that is open at it."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import threading

import pytest

from chatter.app.workbench.page import Workbench
from chatter.app.workbench.server import WorkbenchServer
from tests.chatter.app.browser_tab import PATIENCE, browser, tab_of
from tests.places import EXAMPLES


@contextlib.contextmanager
def serving(folder):
    """Serve a folder in a thread, until the block ends."""
    begun: list[WorkbenchServer] = []
    ready = threading.Event()

    def serve():
        asyncio.set_event_loop(asyncio.new_event_loop())
        begun.append(WorkbenchServer(folder))
        ready.set()
        begun[0].serve()

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    assert ready.wait(PATIENCE)
    yield begun[0]
    begun[0].end()
    thread.join(PATIENCE)


@pytest.fixture
def served(tmp_path):
    folder = tmp_path / "work"
    folder.mkdir()
    with serving(folder) as server:
        yield folder, server
    gc.collect()  # what was not sent is left here, and not after the last test


@pytest.fixture
def tab(tmp_path, served):
    profile = tmp_path / "profile"
    profile.mkdir()
    with browser(profile) as port:
        found = tab_of(port)
        found.open(served[1].url)
        yield found
        found.close()


@pytest.fixture
def workbench(tmp_path):
    text = (EXAMPLES / "two-degrees-of-freedom" / "case.toml").read_text()
    # few speeds, so that studies are quick
    (tmp_path / "case.toml").write_text(text.replace(":400", ":60"))
    page = Workbench(tmp_path)
    yield page
    page.end()
