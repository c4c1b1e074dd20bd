"""Score what ``chatter explain`` made of blind sets: ``python -m benchmarks.blind_sets.score OUT``.

For every set it takes OUT/explained/SET/explanation.json (or the one in the set itself), running
``chatter explain`` first where there is none, and holds it against OUT/truth/SET. Runs that the
explanation has never seen are predicted with its case-updated.toml; the error is the mean over the
channels of the rms over the runs of (error over signal), as is the noise floor.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

CHANNELS = {"Fx [N]": ("force", 0, 1.0), "Fy [N]": ("force", 1, 1.0),
            "x [um]": ("displacement", 0, 1e6), "y [um]": ("displacement", 1, 1e6)}  # fmt: skip
#: effects that data cannot tell apart once the friction is free
_TWINS = ({"asymmetry", "offset"},)
#: bound of the error on unseen runs over the noise floor; of the reported over the found error
#: the command line, under the same Python
_CHATTER = "from chatter.cli import main; main()"
_AT_FLOOR, _AGREES = 1.3, 0.2


@dataclass
class Score:
    """One line of the table; ``None`` where a question does not arise."""

    name: str
    truth: str
    verdict: str
    named: str
    verdict_right: bool
    names_right: bool
    wrong_name: bool
    intervals_met: int
    intervals: int
    off: str
    unseen: float | None
    floor: float | None
    reported: float | None
    seen: float | None
    seconds: float | None

    @property
    def ratio(self) -> float | None:
        """Error on unseen runs over the noise floor."""
        return self.unseen / self.floor if self.unseen and self.floor else None


def toml(path: Path) -> dict[str, Any]:
    """Content of a TOML file."""
    return tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()


def explained(out: Path, name: str, run: bool, again: bool) -> tuple[Path | None, float | None]:
    """Folder with explanation.json of a set, made where there is none; and the time it took."""
    place = out / "explained" / name
    if (out / name / "explanation.json").is_file():
        return out / name, None
    if (place / "explanation.json").is_file() and not again:
        return place, None
    if not run:
        return None, None
    begun = time.perf_counter()
    command = [sys.executable, "-c", _CHATTER, "explain", str(out / name), "--out", str(place)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"{name}: explain returned {done.returncode}: {done.stderr.strip()[-600:]}")
        return None, time.perf_counter() - begun
    return place, time.perf_counter() - begun


def score_set(out: Path, name: str, run: bool = True, again: bool = False) -> Score | None:
    """Score of a set, or None where nothing has explained it."""
    truth = toml(out / "truth" / name / "truth.toml")
    place, seconds = explained(out, name, run, again)
    if place is None:
        return None
    found = json.loads((place / "explanation.json").read_text(encoding="utf-8"))
    effects = found["effects"]
    named = [one["name"] for one in effects]
    met, asked, off = _intervals(effects, truth.get("expected", {}))
    case = place / "case-updated.toml"
    unseen = _error(truth["kind"], case, out / "truth" / name / "unseen")
    seen = _error(truth["kind"], case, out / name)
    floor = found["error"]["noise_floor"]
    if truth["kind"] == "milling":
        shares = np.asarray(truth["noise_unseen"])
        floor = float(np.mean(np.sqrt(np.mean(shares**2, axis=0))))
    true = truth["effects"]
    right = _names_right(effects, true, truth["verdict"])
    wrong = any(not _is_one_of(one, true) for one in effects)
    return Score(
        name, "+".join(true) or "none", found["verdict"], "+".join(named) or "-",
        found["verdict"] == truth["verdict"], right, wrong, met, asked, off, unseen, floor,
        found["error"].get("after"), seen, seconds,
    )  # fmt: skip


def _is_one_of(effect: Mapping[str, Any], true: list[str]) -> bool:
    """Whether an effect is true, or a twin of a true one that it says it cannot be told from."""
    if effect["name"] in true:
        return True
    confounded = set(effect.get("confounded_with", ()))
    return any(effect["name"] in twins and bool(twins & set(true) & confounded) for twins in _TWINS)


def _names_right(effects: list[Mapping[str, Any]], true: list[str], verdict: str) -> bool:
    """One effect: named first. Two: both named and no other. None or unlisted: none named."""
    if verdict not in ("explained", "explained-in-part"):
        return not effects
    if len(true) == 1:
        return bool(effects) and _is_one_of(effects[0], true)
    return len(effects) == len(true) and all(_is_one_of(one, true) for one in effects)


def _intervals(effects, expected: Mapping[str, Mapping[str, float]]) -> tuple[int, int, str]:
    """How many stated 95 % intervals hold the true value, of how many; and which do not."""
    met, asked, off = 0, 0, []
    for effect in effects:
        true = {key.lower(): value for key, value in expected.get(effect["name"], {}).items()}
        for key, stated in effect["parameters"].items():
            if key.lower() not in true or stated["ci95"] is None:
                continue
            asked += 1
            low, high = stated["ci95"]
            value = true[key.lower()]
            if effect["name"] == "runout" and key == "angle":
                half, turn = 0.5 * abs(high - low), 2.0 * math.pi
                away = (value - 0.5 * (low + high) + math.pi) % turn - math.pi
                inside = abs(away) <= half
            else:
                inside = low <= value <= high
            met += inside
            if not inside:
                wide = (high - low) / 3.92
                sigmas = (value - stated["value"]) / wide if wide else math.inf
                off.append(f"{effect['name']}.{key} ({sigmas:+.1f} s)")
    return met, asked, ", ".join(off)


def _error(kind: str, case: Path, folder: Path) -> float | None:
    """Error of the predictions of all runs of a folder with a case, mean over the channels."""
    if not case.is_file() or not (folder / "measurement.toml").is_file():
        return None
    errors = _simulated(case, folder) if kind == "milling" else _compared(case, folder)
    return float(np.mean(np.sqrt(np.mean(np.square(errors), axis=0))))


def _simulated(case: Path, folder: Path) -> np.ndarray:
    """Errors (runs, channels) of simulations under the conditions of each run."""
    import chatter

    updated = chatter.load(case)
    rows = []
    for run in toml(folder / "measurement.toml")["run"]:
        with (folder / run["file"]).open(encoding="utf-8") as file:
            heading = file.readline().strip().split(",")
            data = dict(zip(heading, np.loadtxt(file, delimiter=",").T, strict=True))
        own = updated.patch({f"cut.{key}": value for key, value in run.items() if key != "file"})
        seconds = data["time [s]"][-1]
        turns = seconds * own.cut.spindle_speed / (2.0 * math.pi) + 0.5
        result = chatter.simulate(own.patch({"simulation.revolutions": float(turns)}))
        row = []
        for channel, (kind, axis, scale) in CHANNELS.items():
            signal = data[channel]
            values = np.interp(data["time [s]"], result.time, getattr(result, kind)[:, axis])
            error = np.sqrt(np.mean(np.square(scale * values - signal)))
            row.append(error / np.sqrt(np.mean(np.square(signal))))
        rows.append(row)
    return np.array(rows)


def _compared(case: Path, folder: Path) -> np.ndarray:
    """Errors (runs, channels) as ``chatter compare`` gives them."""
    from chatter.explain.comparison import compare
    from chatter.explain.measurement_file import read_measurement

    found = compare(read_measurement(folder, case)).errors
    channels = sorted({one.channel for one in found})
    runs = list(dict.fromkeys(one.run for one in found))
    table = np.full((len(runs), len(channels)), np.nan)
    for one in found:
        table[runs.index(one.run), channels.index(one.channel)] = one.relative
    return table if not np.isnan(table).any() else np.nanmean(table, axis=1, keepdims=True)


# table -------------------------------------------------------------------------------------------


def _shown(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def print_table(scores: list[Score]) -> None:
    """One line a set."""
    print(
        f"{'set':9} {'truth':30} {'verdict':15} {'named':30} {'ok':3} {'CI':>5} {'seen':>7} "
        f"{'report':>7} {'unseen':>7} {'floor':>7} {'ratio':>6} {'s':>4}  off"
    )
    for one in scores:
        right = "yes" if one.verdict_right and one.names_right else "NO"
        print(
            f"{one.name:9} {one.truth:30} {one.verdict:15} {one.named:30} {right:3} "
            f"{f'{one.intervals_met}/{one.intervals}':>5} {_shown(one.seen, '7.4f'):>7} "
            f"{_shown(one.reported, '7.4f'):>7} {_shown(one.unseen, '7.4f'):>7} "
            f"{_shown(one.floor, '7.4f'):>7} {_shown(one.ratio, '6.2f'):>6} "
            f"{_shown(one.seconds, '4.0f'):>4}  {one.off}"
        )


def totals(scores: list[Score], out: Path) -> dict[str, str]:
    """Shares of what the sets ask for."""
    truths = {one.name: toml(out / "truth" / one.name / "truth.toml") for one in scores}

    def of(verdict: str, count: int | None = None) -> list[Score]:
        return [
            one
            for one in scores
            if truths[one.name]["verdict"] == verdict
            and (count is None or len(truths[one.name]["effects"]) == count)
        ]

    def share(met: list[bool]) -> str:
        return f"{sum(met)} of {len(met)}"

    explained_sets = of("explained")
    reported = [(one.reported, one.seen) for one in explained_sets if one.reported and one.seen]
    intervals = (sum(s.intervals_met for s in scores), sum(s.intervals for s in scores))
    unlisted = [one.verdict_right for one in of("unexplained")]
    return {
        "one effect: named first": share([one.names_right for one in of("explained", 1)]),
        "two effects: both named": share([one.names_right for one in of("explained", 2)]),
        "nothing missing: said so": share([one.verdict_right for one in of("nothing-missing")]),
        "in no list: unexplained": share(unlisted),
        "sets with a wrong name": str(sum(one.wrong_name for one in scores)),
        f"unseen error within {_AT_FLOOR} of the floor": share(
            [one.ratio <= _AT_FLOOR for one in explained_sets if one.ratio is not None]
        ),
        "reported error agrees": share([abs(a / b - 1.0) <= _AGREES for a, b in reported]),
        "95 % intervals met": f"{intervals[0]} of {intervals[1]}",
    }


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.blind_sets.score", description=__doc__
    )
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", default="set-*", help="pattern of the sets' names")
    parser.add_argument("--no-run", action="store_true", help="score what is explained already")
    parser.add_argument("--again", action="store_true", help="explain again what was explained")
    given = parser.parse_args()
    scores = []
    for place in sorted(given.out.glob(given.only)):
        one = score_set(given.out, place.name, not given.no_run, given.again)
        if one is not None:
            print_table([one])
            scores.append(one)
    print()
    print_table(scores)
    print()
    for name, value in totals(scores, given.out).items():
        print(f"{name:45} {value}")


if __name__ == "__main__":
    main()
