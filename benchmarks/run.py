"""Run every benchmark in this folder, one after the other."""

import runpy
from pathlib import Path

if __name__ == "__main__":
    here = Path(__file__).parent
    for script in sorted(here.glob("*.py")):
        if script.name != Path(__file__).name:
            print(f"== {script.name}", flush=True)
            runpy.run_path(str(script), run_name="__main__")
