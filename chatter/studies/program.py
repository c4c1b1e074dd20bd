"""What results depend on beside their input: the program and its libraries."""

import hashlib
from functools import cache
from pathlib import Path

#: layers above the compiled code that results are computed in
_COMPUTING = ("explain", "learning", "studies")


@cache
def program() -> str:
    """Hash of all sources that results are computed by, and of the libraries."""
    from chatter.engine.presets import CACHE_FOLDER

    # the folder of compiled code is named by a hash of what lies below these layers
    digest = hashlib.sha256(CACHE_FOLDER.name.encode())
    root = Path(__file__).resolve().parents[1]
    for layer in _COMPUTING:
        for path in sorted((root / layer).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
