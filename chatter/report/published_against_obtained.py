"""Table of what a publication found beside what a model obtains."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from chatter.report.console import print_table

#: nothing of the model was fitted or chosen with this number in view
PREDICTED = "predicted"
#: a parameter was fitted to this number
CALIBRATED = "calibrated on this"
#: a choice that the publication leaves open was made with this number in view
SELECTED = "selected for this"
#: made by the model itself and found again: checks the method, not the model
RECOVERED = "own data recovered"
#: deviation within which a predicted number is near the published one, and a frequency
_NEAR, _NEAR_FREQUENCY = 0.15, 0.05
KINDS = (PREDICTED, CALIBRATED, SELECTED, RECOVERED)


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
    kind : str
        One of `KINDS`: what the row proves.

    Raises
    ------
    ValueError
        If `kind` is none of them.
    """

    what: str
    published: float | str
    obtained: float | str
    unit: str = ""
    source: str = ""
    kind: str = PREDICTED

    def __post_init__(self) -> None:
        """Refuse a kind that is none."""
        if self.kind not in KINDS:
            raise ValueError(f"{self.kind!r} is none of {', '.join(KINDS)}")

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
    headers = ["finding", "kind", "published", "obtained", "deviation", "source"]
    rows = [
        [
            one.what,
            one.kind,
            _shown(one.published, one.unit),
            _shown(one.obtained, one.unit),
            "" if one.deviation is None else f"{100.0 * one.deviation:+.1f} %",
            one.source,
        ]
        for one in findings
    ]
    print_table(f"published and obtained; {_tally(findings)}", headers, rows)
    path = Path(folder) / "findings.csv"
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(headers)
        writer.writerows(rows)
    return path


def _tally(findings: Sequence[Finding]) -> str:
    """How many of the predicted numbers come near, in words."""
    predicted = [
        (_NEAR_FREQUENCY if one.unit == "Hz" else _NEAR, abs(one.deviation))
        for one in findings
        if one.kind == PREDICTED and one.deviation is not None
    ]
    near = sum(apart <= allowed for allowed, apart in predicted)
    return (
        f"of {len(predicted)} predicted numbers {near} within {100.0 * _NEAR:.0f} % "
        f"(frequencies {100.0 * _NEAR_FREQUENCY:.0f} %)"
    )


def _shown(value: float | str, unit: str) -> str:
    text = value if isinstance(value, str) else f"{value:.4g}"
    return f"{text} {unit}".strip()
