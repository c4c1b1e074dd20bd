"""Progress of long work on the terminal, and what the first use takes."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from chatter.description import progress
from chatter.report.console import MESSAGES, print_message


@contextmanager
def progress_bar(description: str, driver: object | None = None) -> Iterator[progress.Progress]:
    """Announce what the first use takes, and show a progress bar on stderr.

    Yields a function of (done, total); `driver` is as for `announce_compilation`.
    """
    announce_compilation(driver)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=MESSAGES, transient=True) as bar:
        task = bar.add_task(description, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def announce_compilation(driver: object | None = None) -> None:
    """Announce that the first use compiles, where the cache does not hold the kernels yet.

    Parameters
    ----------
    driver : compiled function, optional
        The only one asked for; by default any kernel will do.
    """
    from chatter.engine.presets import CACHE_FOLDER, is_compiled

    known = any(CACHE_FOLDER.rglob("*.nbi")) if driver is None else is_compiled(driver)
    if not known:
        print_message("first use: compiling the numerical kernels, once, about half a minute ...")


def announce_resumed(noun: str, before: int, total: int) -> None:
    """Announce how many parts of a study an earlier run has finished."""
    print_message(f"{before} of {total} {noun} were finished before")
