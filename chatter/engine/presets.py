"""Decorator presets of the compiled code, and the folder that keeps it between sessions.

Physics leaves in `cutting` and `dynamics` are plain functions to Python, inlined by the drivers
here (see `cutting.compiled` and `cutting.leaves`). numba's disk cache looks only at the file of
the cached function, so that an edit of a leaf would go unseen, and so would another version of
numpy; the cache folder is therefore named by a hash of all sources and of the libraries.
"""

import hashlib
import os
import shutil
import time
from importlib.metadata import version
from pathlib import Path

import numba

from chatter.description.registry import extension_sources
from chatter.engine.compiled_once import compile_once
from chatter.engine.interruption import defer_interruptions
from chatter.engine.loaded_kernels import load_without_compiler
from cutting.compiled import UNCOUNTED

#: compiled code of other versions is kept this long, s
_KEEP_OLD_CACHES = 30 * 86400.0

_PACKAGES = ("chatter", "cutting", "dynamics")
#: layers above every compiled function: none of them can be imported by one
ABOVE_COMPILED = (
    *("app", "cli", "cutting_coefficients", "drive_friction", "explain", "first_steps"),
    *("learning", "monitoring", "operator_sheet", "plots", "report", "studies"),
)
#: what compiled code is made by and calls
_LIBRARIES = ("numba", "llvmlite", "numpy", "scipy")


def source_hash(root: Path) -> str:
    """Hash of every Python source in `root` that compiled code may hold, extensions, libraries."""
    digest = hashlib.sha256()
    for library in _LIBRARIES:
        digest.update(f"{library} {version(library)}\n".encode())
    for package in _PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            inside = path.relative_to(root)
            if package == "chatter" and inside.parts[1] in ABOVE_COMPILED:
                continue
            digest.update(inside.as_posix().encode())
            digest.update(path.read_bytes())
    for path in extension_sources():
        digest.update(path.as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_base() -> Path:
    """Folder of all caches: $NUMBA_CACHE_DIR, else the user's cache folder."""
    named = os.environ.get("NUMBA_CACHE_DIR")
    if named:
        return Path(named)
    home = os.environ.get("XDG_CACHE_HOME")
    return (Path(home) if home else Path.home() / ".cache") / "chatter"


def _remove_old_caches(base: Path, current: str) -> None:
    for folder in base.glob("kernels-*"):
        too_old = time.time() - folder.stat().st_mtime > _KEEP_OLD_CACHES
        if folder.name != current and too_old:
            shutil.rmtree(folder, ignore_errors=True)


def _set_cache_folder() -> Path:
    base = cache_base()
    folder = base / f"kernels-{source_hash(Path(__file__).resolve().parents[2])}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _remove_old_caches(base, folder.name)
    except OSError:
        # a read-only home: numba falls back to its own choice
        return folder
    numba.config.CACHE_DIR = str(folder)
    load_without_compiler(folder)
    compile_once()
    return folder


CACHE_FOLDER = _set_cache_folder()
defer_interruptions()

#: functions that Python calls too
KERNEL = {"cache": True, "error_model": UNCOUNTED["error_model"]}
#: the same where the call itself would cost: a table that is passed on has all its arrays counted
INLINED_KERNEL = {**KERNEL, "forceinline": True}
#: functions that compiled code alone calls: no entry for Python, kept on disk within their drivers
INNER_KERNEL = {
    "error_model": KERNEL["error_model"],
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}
#: sums may be taken in lanes: always in the same order on one machine, whatever the threads
SUMMING_KERNEL = {**INNER_KERNEL, "fastmath": {"reassoc", "contract", "nsz"}}
#: the same that allocate nothing: arrays taken out of the tables they are passed need no counting,
#: which would cost more than what most of them do
LEAF_KERNEL = {**INNER_KERNEL, **UNCOUNTED}
#: the same where passing on the tables would cost more than what is done with them
INLINED_LEAF_KERNEL = {**LEAF_KERNEL, "forceinline": True}
#: functions with one caller, which becomes part of it
SINGLE_KERNEL = {**INNER_KERNEL, "inline": "always"}
#: loops over points, called from Python, in several threads at once
DRIVER = {**KERNEL, "nogil": True}
#: loops over steps of time, which allocate nothing
TIME_LOOP = {**DRIVER, **UNCOUNTED}


def is_compiled(*dispatchers: object) -> bool:
    """Tell whether every dispatcher has compiled code, in memory or on disk."""
    return all(d.signatures or _on_disk(d) for d in dispatchers)  # type: ignore[attr-defined]


def _on_disk(dispatcher: object) -> bool:
    function = dispatcher.py_func  # type: ignore[attr-defined]
    stem = f"{Path(function.__code__.co_filename).stem}.{function.__qualname__}-"
    return any(CACHE_FOLDER.rglob(f"{stem}*.nbi"))
