"""State of the installation: versions, cores, threads, compiled code, formats."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
import platform
from typing import Any

import numba

from chatter.engine.presets import CACHE_FOLDER

_LIBRARIES = ("chatter", "numpy", "scipy", "numba", "matplotlib", "pydantic", "pint")
#: what extras bring: module -> what it is for
_OPTIONAL = {
    "nptdms": "TDMS files",
    "h5py": "MAT 7.3 files",
    "openpyxl": "XLSX files",
    "pyarrow": "Parquet files",
    "sounddevice": "sound cards",
    "av": "compressed sound",
    "dask": "studies on a cluster",
    "skfem": "solid bodies",
}


def installation() -> dict[str, Any]:
    """What is installed, and where compiled code is kept."""
    return {
        "python": platform.python_version(),
        "system": f"{platform.system()} {platform.machine()}",
        "libraries": {name: _version(name) for name in _LIBRARIES},
        "optional": {
            name: {"for": purpose, "installed": importlib.util.find_spec(name) is not None}
            for name, purpose in _OPTIONAL.items()
        },
        "cores": os.cpu_count(),
        "threads": numba.config.NUMBA_NUM_THREADS,
        "cache": compiled_code(),
    }


def compiled_code() -> dict[str, Any]:
    """Folder of compiled code, how many functions it holds, and their size, MB."""
    compiled = list(CACHE_FOLDER.rglob("*.nbc")) if CACHE_FOLDER.exists() else []
    return {
        "folder": str(CACHE_FOLDER),
        "writable": CACHE_FOLDER.exists() and os.access(CACHE_FOLDER, os.W_OK),
        "compiled_functions": len(compiled),
        "MB": round(sum(path.stat().st_size for path in compiled) / 1e6, 1),
    }


def _version(name: str) -> str:
    if name == "chatter":
        import chatter

        return chatter.__version__
    return importlib.metadata.version(name)
