"""The page of a session: case files of the folder, and the views of the one that is chosen."""

from collections.abc import Callable
from pathlib import Path

import panel as pn

from chatter.app.workbench.stability_view import StabilityView
from chatter.description.case import load
from chatter.description.errors import InputError


def case_files(folder: Path) -> list[str]:
    """Names of the case files in a folder, and one level below; links out of it are left out."""
    root = folder.resolve()
    found = sorted([*root.glob("*.toml"), *root.glob("*/*.toml")])
    inside = [path for path in found if path.resolve().is_relative_to(root)]
    return [path.relative_to(root).as_posix() for path in inside if _is_cut(path)]


def _is_cut(path: Path) -> bool:
    """Whether the file has what a diagram is made of; a file that is no case has not."""
    try:
        case = load(path)
    except InputError:
        return False
    return all((case.tool, case.material, case.cut, case.structure))


class Workbench:
    """Page of one session."""

    def __init__(self, folder: Path, first: str | None = None) -> None:
        self._folder, self._document = folder.resolve(), pn.state.curdoc
        files = case_files(folder)
        first = first if first in files else next(iter(files), None)
        self.choice = pn.widgets.Select(label="Case", options=files, value=first)
        self.message = pn.pane.Str("" if files else f"no case file of a cut in {folder.name}")
        self.stability: StabilityView | None = None
        self._views = pn.Column()
        self.choice.param.watch(lambda _: self._open(), "value")
        self._open()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the page."""
        return pn.Column(pn.Row(self.choice, self.message), self._views)

    def end(self) -> None:
        """Give up what is computed for this session."""
        if self.stability is not None:
            self.stability.computations.cancel()

    def _open(self) -> None:
        self.end()
        name = self.choice.value
        if name is None:
            return
        try:
            case = load(self._folder / name)
            self.stability = StabilityView(case, name, self._in_the_page)
        except InputError as error:
            self.message.object, self._views.objects = str(error), []
            return
        self.message.object = case.title
        self._views.objects = [pn.Tabs(("Stability", self.stability.__panel__()))]

    def _in_the_page(self, change: Callable[[], None]) -> None:
        """Change the page from another thread; without a browser, at once."""
        if self._document is None:
            change()
        else:
            self._document.add_next_tick_callback(change)
