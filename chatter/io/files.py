"""Measured files: opened within limits, text told from binary content and decoded."""

from pathlib import Path

from dynamics.frf.container import MeasurementError

#: largest file read, bytes: a record of ten million samples is smaller
LARGEST_FILE = 1024**3

#: share of letters that are Latin
_MOSTLY = 0.95
_BYTE_ORDER_MARKS = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}


def require_readable(path: Path) -> None:
    """Raise MeasurementError where `path` is no file, is empty or too large."""
    if path.is_dir():
        raise MeasurementError(f"{path}: is a folder; name a file in it")
    if not path.exists():
        raise MeasurementError(f"{path}: no such file")
    if not path.is_file():
        raise MeasurementError(f"{path}: is not an ordinary file")
    size = path.stat().st_size
    if size == 0:
        raise MeasurementError(f"{path}: the file is empty")
    if size > LARGEST_FILE:
        raise MeasurementError(
            f"{path}: the file has {size / 1024**2:.0f} MB; at most {LARGEST_FILE / 1024**2:.0f} "
            "MB are read"
        )


def read_content(path: Path, size: int = -1) -> bytes:
    """Read a file, or its first bytes.

    MeasurementError if it is missing, a folder, empty, too large or unreadable.
    """
    require_readable(path)
    try:
        with path.open("rb") as stream:
            return stream.read(size)
    except OSError as error:
        raise MeasurementError(f"{path}: cannot be read ({error.strerror})") from error


def decoded(raw: bytes, path: Path) -> str:
    """Decode text (UTF-8, UTF-16 with its mark, or Windows-1252); refuse binary content."""
    for mark, encoding in _BYTE_ORDER_MARKS.items():
        if raw.startswith(mark):
            return raw.decode(encoding, errors="replace")
    wide = _of_two_bytes(raw[:4096])
    if wide is not None:
        return raw.decode(wide, errors="replace")
    # what a program reserved and did not fill
    raw = raw.rstrip(b"\0")
    control = sum(raw[:4096].count(byte) for byte in range(32) if byte not in b"\t\n\r\f\x1a")
    if b"\0" in raw or control > 0.01 * min(len(raw), 4096):
        raise MeasurementError(f"{path}: is not text (binary content)")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _of_two_bytes(raw: bytes) -> str | None:
    """Encoding of text in UTF-16 without its mark: every second byte of Latin letters is zero."""
    half = len(raw) // 2
    for first, encoding in ((1, "utf-16-le"), (0, "utf-16-be")):
        zeros = raw[first::2].count(0)
        if half > 1 and zeros > _MOSTLY * half and raw[1 - first :: 2].count(0) == 0:
            return encoding
    return None


def read_lines(path: Path) -> list[str]:
    """Read the lines of a text file.

    MeasurementError if the file is missing, a folder, empty, too large, unreadable or not text.
    """
    lines = decoded(read_content(path), path).splitlines()
    if not any(line.strip() for line in lines):
        raise MeasurementError(f"{path}: the file holds no text")
    return lines
