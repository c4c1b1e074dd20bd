"""Slider to drawn diagram of the workbench in headless chromium, and memory over many moves.

    python -m benchmarks.workbench_in_browser [--timed 200] [--moves 10000]

Two modes in each direction, collocation; `chatter app` runs in a process of its own, and the time
runs from the new value of the slider in the browser until its diagram is painted; on a busy machine
the processor times of server and page say more. Memory is that of the process of the server and of
the heap, nodes and listeners of the page, garbage collected.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from benchmarks.workbench import memory, two_modes_a_direction
from tests.chatter.app.browser_tab import Tab, browser, tab_of

#: times that memory is looked at over the moves
_LOOKS = 10

#: milliseconds from a value of the slider until its diagram is painted
TIME = """
new Promise(resolve => {
  const models = [...Bokeh.documents[0]._all_models.values()];
  const slider = models.find(one => one.title && String(one.title).startsWith("Ktc"));
  const limits = models.find(one => one.data && "stable" in one.data);
  const plot = models.find(one => one.renderers
    && one.renderers.some(drawn => drawn.data_source === limits));
  const {repainted} = Bokeh.index.find_one(plot);
  const change = limits.properties.data.change;
  const painted = () => {
    repainted.disconnect(painted);
    // after what else the frame does
    setTimeout(() => resolve(performance.now() - begun));
  };
  const arrived = () => { change.disconnect(arrived); repainted.connect(painted); };
  change.connect(arrived);
  const begun = performance.now();
  slider.value = VALUE;
})
"""


@contextmanager
def served(folder: Path) -> Iterator[tuple[str, int]]:
    """Address of `chatter app` on a folder, and the number of its process."""
    command = [sys.executable, "-m", "chatter", "app", str(folder), "--no-browser"]
    serving = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert serving.stdout is not None
        words = (word for line in serving.stdout for word in line.split())
        yield next(word for word in words if "http://" in word), serving.pid
    finally:
        serving.terminate()
        serving.wait()


def time_of(tab: Tab, number: int) -> float:
    """Time of a move of the slider, ms."""
    return tab.value(TIME.replace("VALUE", json.dumps(600.0 + 5.625 * (number % 40 - 20))))


def processor_times(tab: Tab, server: int) -> tuple[float, float]:
    """Processor time that the server and the process of the page have taken, s."""
    fields = Path(f"/proc/{server}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    ticks = int(fields[11]) + int(fields[12])  # of the user and of the system
    metrics = tab.command("Performance.getMetrics")["metrics"]
    page = next(one["value"] for one in metrics if one["name"] == "ProcessTime")
    return ticks / os.sysconf("SC_CLK_TCK"), page


def print_memory(tab: Tab, server: int, moves: int) -> None:
    """Print what the server and the page take."""
    tab.command("HeapProfiler.collectGarbage")
    heap = tab.command("Runtime.getHeapUsage")["usedSize"] / 1e6
    counted = tab.command("Memory.getDOMCounters")
    print(
        f"  {moves} moves: server {memory(server):.0f} MB; page {heap:.1f} MB, "
        f"{counted['nodes']} nodes, {counted['jsEventListeners']} listeners",
        flush=True,
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--timed", type=int, default=200)
    parser.add_argument("--moves", type=int, default=0)
    given = parser.parse_args()
    folder = Path(tempfile.mkdtemp())
    (folder / "case.toml").write_text(two_modes_a_direction().to_toml(), encoding="utf-8")
    (folder / "profile").mkdir()
    with served(folder) as (url, server), browser(folder / "profile") as port:
        tab = tab_of(port)
        tab.open(url)
        tab.wait_for_text("chatter lobes case.toml")
        tab.wait(
            "[...Bokeh.documents[0]._all_models.values()].some(one => one.data"
            " && 'stable' in one.data && one.data.stable.length)"
        )
        tab.command("Performance.enable")
        before = processor_times(tab, server)
        walls = [time_of(tab, number) for number in range(given.timed)]
        after = processor_times(tab, server)
        for number in range(given.moves):
            if number % max(1, given.moves // _LOOKS) == 0:
                print_memory(tab, server, number)
            time_of(tab, number)
        if given.moves:
            print_memory(tab, server, given.moves)
        tab.close()
    shutil.rmtree(folder, ignore_errors=True)
    print(
        f"slider to drawn diagram, {given.timed} moves: median {statistics.median(walls):.0f} ms, "
        f"90 % below {sorted(walls)[int(0.9 * len(walls))]:.0f} ms"
    )
    of_server, of_page = (
        1e3 * (end - begin) / given.timed for begin, end in zip(before, after, strict=True)
    )
    print(f"processor time a move: server {of_server:.0f} ms, page {of_page:.0f} ms")


if __name__ == "__main__":
    main()
