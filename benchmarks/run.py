"""Run every benchmark in this folder, one after the other; the table is `python -m benchmarks`."""

import runpy
from pathlib import Path

if __name__ == "__main__":
    here = Path(__file__).parent
    for script in sorted(here.glob("*.py")):
        if script.name not in (Path(__file__).name, "__main__.py"):
            print(f"== {script.name}", flush=True)
            runpy.run_path(str(script), run_name="__main__")
