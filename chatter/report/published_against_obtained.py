"""Table of what a publication found beside what a model obtains."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from chatter.report.console import print_table


@dataclass(frozen=True)
class Finding:
    """One published finding.

    Parameters
    ----------
    what : str
    published, obtained : float or str
    unit : str
    source : str
        Where it is published: figure, table, section.
    calibrated : bool
        Whether the model was fitted to it, so that it proves nothing.
    """

    what: str
    published: float | str
    obtained: float | str
    unit: str = ""
    source: str = ""
    calibrated: bool = False

    @property
    def deviation(self) -> float | None:
        """Obtained over published less one; None where one is not a number."""
        if isinstance(self.published, str) or isinstance(self.obtained, str):
            return None
        return self.obtained / self.published - 1.0 if self.published else None


def write_findings(findings: Sequence[Finding], folder: str | Path) -> Path:
    """Print findings as a table and write findings.csv.

    Parameters
    ----------
    findings : sequence of Finding
    folder : path
        Made where it is missing.
    """
    headers = ["finding", "published", "obtained", "deviation", "source"]
    rows = [
        [
            one.what + (" (calibrated)" if one.calibrated else ""),
            _shown(one.published, one.unit),
            _shown(one.obtained, one.unit),
            "" if one.deviation is None else f"{100.0 * one.deviation:+.1f} %",
            one.source,
        ]
        for one in findings
    ]
    print_table("published and obtained", headers, rows)
    path = Path(folder) / "findings.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(headers)
        writer.writerows(rows)
    return path


def _shown(value: float | str, unit: str) -> str:
    text = value if isinstance(value, str) else f"{value:.4g}"
    return f"{text} {unit}".strip()
