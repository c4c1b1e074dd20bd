"""Files dropped on the page: bounded while they arrive, written under plain names."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import panel as pn

from chatter.app.workbench.session import LARGEST_FILE, LARGEST_UPLOAD, MOST_FILES

#: bytes of a part of a file, in one message
PART = 512 * 1024
#: s without a part of a file after which the next file is of another drop: the page sends those of
#: one without a pause
_PAUSE = 1.0
#: s after a file in which another may be of the same drop
LATE = 15.0


class BoundedFileDropper(pn.widgets.FileDropper):  # type: ignore[misc, unused-ignore]
    """File dropper that gives up files larger than allowed, whatever the page sends."""

    def __init__(self, **given: Any) -> None:
        super().__init__(**given)
        self._forgotten: dict[str, Any] = {}
        self._last_part = -_PAUSE
        #: called with the name of the first file of a drop as it begins to come
        self.begun: Callable[[str], None] = lambda _: None
        #: called with the name of a file that is not complete yet and the share that has come
        self.arriving: Callable[[str, float], None] = lambda *_: None
        #: called with the name of a file that is taken off the list
        self.removed: Callable[[str], None] = lambda _: None

    def pause(self) -> float:
        """Time since the last part of a file came, s."""
        return time.monotonic() - self._last_part

    def forget(self) -> None:
        """Hand over what stands in the list now no more; a file that is dropped again is new."""
        self._forgotten = dict(self.value)

    def files(self) -> dict[str, bytes]:
        """Files that were dropped, by name."""
        return {name: content if isinstance(content, bytes) else content.encode()
                for name, content in self.value.items()
                if self._forgotten.get(name) is not content}  # fmt: skip

    def _process_event(self, event: Any) -> None:
        data = event.data
        if event.event_name == "delete_event":
            if data.get("name") in self.files():  # those handed over before are of other drops
                self.removed(data["name"])
            super()._process_event(event)
            return
        name, part = data.get("name"), data.get("data", b"")
        if not isinstance(name, str) or not isinstance(part, bytes):
            return
        if data.get("chunk") != 1 and name not in self._file_buffer:
            return  # rest of a file that was given up
        if not self._file_buffer and self.pause() > _PAUSE:
            self.begun(name)
        self._take_part(event, name, part)
        self._last_part = time.monotonic()

    def _take_part(self, event: Any, name: str, part: bytes) -> None:
        """Take a part of a file, unless the files become too large or too many by it."""
        data = event.data
        waiting = sum(len(one) for one in self._file_buffer.get(name, ())) + len(part)
        together = sum(len(one) for parts in self._file_buffer.values() for one in parts)
        together += sum(map(len, self.value.values())) + len(part)
        many = len(self._file_buffer) + len(self.value) >= MOST_FILES and data.get("chunk") == 1
        if waiting > LARGEST_FILE or together > LARGEST_UPLOAD or many:
            self._file_buffer.pop(name, None)
            return
        super()._process_event({**event, "data": data} if isinstance(event, dict) else event)
        chunk, parts = data.get("chunk"), data.get("total_chunks")
        if name in self._file_buffer and isinstance(chunk, int) and isinstance(parts, int):
            self.arriving(name, min(1.0, chunk / max(1, parts)))


def dropper(take: Callable[[dict[str, bytes]], None], label: str) -> BoundedFileDropper:
    """File dropper that hands over files as they are complete, by name."""
    widget = BoundedFileDropper(
        label=label, multiple=True, chunk_size=PART, max_file_size=f"{LARGEST_FILE >> 20}MB",
        height=110, width=420,
    )  # fmt: skip

    def changed(_: Any) -> None:
        files = widget.files()
        if files:
            take(files)

    widget.param.watch(changed, "value")
    return widget
