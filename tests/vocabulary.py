"""Words that the project does not use, where they are forbidden, and the field's terms for them.

``python -m tests.vocabulary`` lists every hit by file.  A word that is also a term of the field
("lead" of a screw, "tie" of two surfaces) is forbidden only in the folders of its other sense.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.places import ROOT

PACKAGES = ("chatter", "cutting", "dynamics")


@dataclass(frozen=True)
class Word:
    """A forbidden word and what replaces it."""

    term: str
    names: str = ""  # words of identifiers and of keys, apart by spaces; "a_b" as neighbours
    texts: str = ""  # regular expression over messages, help and documents
    within: tuple[str, ...] = PACKAGES  # folders where the names are forbidden


_FRICTION = ("dynamics/friction", "chatter/description", "chatter/compile", "dynamics/machine")

WORDS = (
    # stability and numerics
    Word(
        "critical depth",
        "limit_depth limit_depths deepest searched_to",
        r"limit depths?|searched to",
    ),
    Word("spectral radius or growth rate", "growth!rate"),
    Word("monodromy (solution) operator", "element_map period_map", r"(element|period) maps?"),
    Word("boundary continuation", "=following", r"following the (boundary|limit)"),
    Word("grid", "net nets shared_net", r"nets?"),
    Word("evaluation, screening", "look looks looked", r"(first|second) look|looked (again|at)"),
    Word("stable interval", "stretch stretches", r"stretch(es)?"),
    Word("chatter frequency evaluated", "heard listened listen", r"heard|listened"),
    Word("coupling assembly", "cut_plan cut_plans step_plan step_plans", r"(cut|step) plans?"),
    Word(
        "edge segments, segment groups",
        "piece pieces chain chains",
        r"edge pieces?",
        within=("cutting", "chatter/stability", "chatter/compile"),
    ),
    Word("SIMD batch", "lane lanes", r"lanes?"),
    Word("uniform-pitch cylindrical end mill", "alike upright", r"upright|evenly spaced teeth"),
    Word("averaged directional coefficients", "mean_coupling mean_couplings", r"mean couplings?"),
    Word("points per wavelength, refinement", "wave waves fineness", r"fineness"),
    Word(
        "reference speeds",
        "standing_speed standing_speeds speed_groups",
        r"standing speeds?|speed groups?",
    ),
    Word("time-domain", "", r'method "time"|--method time(?!-)'),
    # time domain
    Word(
        "revolution",
        "turn turns",
        r"(a|per|each|every|one|two|three|whole|last|first|next|of|the|many|some|\d+|\{\}) turns?"
        r"(?! (on|off|out|into|up|in|by|to|it))",
    ),
    Word("Poincare section", "once_per_period", r"once[- ]per[- ]period"),
    Word(
        "perturbation, largest Lyapunov exponent",
        "push pushes pushed divergence",
        r"push(es|ed)?|divergence",
    ),
    Word("chatter detection", "judgement judge judgements", r"judgements?"),
    Word("force ramp", "grip takes_hold take_hold", r"tak(es?|ing) hold"),
    Word("forces, commit", "=act =settle =resist"),
    Word("store, clear surface history", "note_wave forget_wave"),
    Word("loss of contact", "missed"),
    Word("step compliance, step mobility; time-domain verification", "held", r"held in time"),
    Word("radial offset", "inset insets", r"insets?"),
    Word("graded quadrature", "crowd crowded crowding", r"crowd(s|ed|ing)?"),
    Word("direction, travel, branch or factor", "way ways"),
    Word("index, position or angle", "place places"),
    # closing the loop
    Word(
        "residual",
        "left_over left_over_noise what_is_left is_left",
        r"what is left(?! out)|left over (the )?noise|left, (refitted|with)",
    ),
    Word("holdout runs", "unseen", r"unseen|not looked at"),
    Word("discriminating test", "told_apart told_apart_by tell_apart", r"t(old|ell) apart"),
    Word("reported, description", "told tells tell telling says say said"),
    Word("significant", "chance", r"(beyond|by) chance"),
    Word("repaired model", "what_was_added", r"what was added"),
    Word("residual dependence", "lead leads", within=("chatter/explain", "chatter/report")),
    Word("depends on, regression", "hangs_on hang_on", r"h(angs?|ung) on"),
    Word("depends on, regression", "tie ties", within=("chatter/explain", "chatter/report")),
    Word("residual diagnostics", "view views", within=("chatter/explain", "chatter/report")),
    Word("nuisance parameters", "merely merely_uncertain", r"merely uncertain"),
    Word("weights", "certainty doubt doubts", r"certainty|(no|in|beyond) doubt"),
    Word("backlash", "play", r"play"),
    Word("prior", "tolerated", r"tolerated"),
    Word("misclassified", "misjudged", r"misjudged"),
    Word("channel assignment", "arrangement arrangements", within=("chatter/explain",)),
    Word("exclusion", "leaving_out left_out leave_out", r"leaving out"),
    # machine, studies, files
    Word("hysteresis slope", "inclination", r"friction inclination", within=_FRICTION),
    Word("velocity-dependent viscous term", "slow_viscous", r"slow[_ ]viscous"),
    Word("full_engagement_share", "full_at", r"full_at"),
    Word("max_pitch_ratio", "largest_chip", r"largest[_ ]chip"),
    Word("radial_depths", "widths", within=("chatter/studies", "chatter/description")),
    Word("process optimisation", "best_cut best_cuts", r"best cuts?"),
    # `chatter sheet` is the operator's page
    Word(
        "speed-depth slice",
        "sheet sheets",
        within=("cutting", "dynamics", "chatter/stability", "chatter/studies"),
    ),
    Word("result cache", "kept_results finished_points", r"kept results|finished points"),
    Word("executor", "=Computing =Here =OnDask"),
    Word(
        "model, summary, presets",
        "subject subjects ready_studies ready_study",
        r"ready stud(y|ies)",
    ),
    Word("drive-point check", "mirror_point mirror_points", r"mirror points?"),
    Word("formatting of values", "shown"),
    Word(
        "published against obtained", "findings", within=("chatter/cli", "chatter/io", "examples")
    ),
)

#: where old keys of files are named, to be read for one release
OLD_KEYS = ("chatter/description/renamed.py",)


@dataclass(frozen=True)
class Hit:
    """One forbidden word at one place."""

    file: str
    line: int
    found: str
    term: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.found!r}: {self.term}"


@cache
def _words(identifier: str) -> list[str]:
    """Words of an identifier in snake or camel case, in lower case."""
    apart = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", identifier)
    return [word for word in re.split(r"[^A-Za-z0-9]+", apart.lower()) if word]


def _named(identifier: str, pattern: str) -> bool:
    """Whether an identifier is `=exactly`, or holds `a_b` side by side, or `a` without `!b`."""
    if pattern.startswith("="):
        return identifier == pattern[1:]
    wanted, _, unless = pattern.partition("!")
    sought, words = _words(wanted), _words(identifier)
    for start in range(len(words) - len(sought) + 1):
        end = start + len(sought)
        if words[start:end] == sought and not (unless and words[end : end + 1] == [unless]):
            return True
    return False


@cache
def _matching(identifier: str) -> list[Word]:
    """Words that an identifier holds, in whatever folder."""
    return [word for word in WORDS if any(_named(identifier, one) for one in word.names.split())]


def in_names(file: str, line: int, identifier: str) -> Iterator[Hit]:
    """Forbidden words in an identifier."""
    for word in _matching(identifier):
        if file.startswith(word.within):
            yield Hit(file, line, identifier, word.term)


def in_text(file: str, line: int, text: str) -> Iterator[Hit]:
    """Forbidden words in a text."""
    for word in WORDS:
        if word.texts and (found := re.search(rf"\b({word.texts})\b", text, re.IGNORECASE)):
            around = text[max(found.start() - 30, 0) : found.end() + 30].replace("\n", " ")
            yield Hit(file, line + text[: found.start()].count("\n"), around.strip(), word.term)


def _joined(node: ast.JoinedStr) -> str:
    """Text of an f-string with {} for what is filled in."""
    return "".join(v.value if isinstance(v, ast.Constant) else "{}" for v in node.values)


class _Walk(ast.NodeVisitor):
    """Public names, keys and messages of a module."""

    def __init__(self, file: str) -> None:
        self.file, self.hits = file, []

    def name(self, node: ast.AST, identifier: str) -> None:
        if not identifier.startswith("_"):
            self.hits += in_names(self.file, node.lineno, identifier)

    def text(self, node: ast.AST, text: str) -> None:
        self.hits += in_text(self.file, node.lineno, text)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        self.name(node, node.name)
        if not node.name.startswith("_") or node.name == "__init__":
            given = node.args
            for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs):
                self.name(argument, argument.arg)
        self.body(node)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        self.name(node, node.name)
        self.fields(node)
        self.body(node)

    def fields(self, node: ast.ClassDef | ast.Module) -> None:
        for one in node.body:
            targets = one.targets if isinstance(one, ast.Assign) else [getattr(one, "target", None)]
            for target in targets:
                if isinstance(target, ast.Name):
                    self.name(target, target.id)

    def body(self, node: ast.AST) -> None:
        """Children without the docstring, which only commands show to users."""
        document = ast.get_docstring(node, clean=False)
        if document and self.file.startswith("chatter/cli"):
            self.text(node.body[0], document)
        for child in ast.iter_child_nodes(node):
            if document is None or child is not node.body[0]:
                self.visit(child)

    def visit_Module(self, node: ast.Module) -> None:
        self.fields(node)
        self.body(node)

    def visit_Dict(self, node: ast.Dict) -> None:
        for key in node.keys:
            if (
                isinstance(key, ast.Constant)
                and isinstance(key.value, str)
                and " " not in key.value
            ):
                self.name(key, key.value)
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, str) and " " in node.value:
            self.text(node, node.value)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        self.text(node, _joined(node))
        for value in node.values:
            if isinstance(value, ast.FormattedValue):
                self.visit(value.value)


def hits_in_source(path: Path) -> list[Hit]:
    """Forbidden words in the names, keys and messages of a module."""
    file = path.relative_to(ROOT).as_posix()
    if file in OLD_KEYS:
        return []
    walk = _Walk(file)
    own = path.parent.name if path.stem == "__init__" else path.stem
    walk.hits += in_names(file, 1, own)
    walk.visit(ast.parse(path.read_text(encoding="utf-8")))
    return walk.hits


def hits_in_document(path: Path) -> list[Hit]:
    """Forbidden words in a document, paragraph by paragraph."""
    file = path.relative_to(ROOT).as_posix()
    lines = path.read_text(encoding="utf-8").splitlines()
    return [hit for number, line in enumerate(lines, 1) for hit in in_text(file, number, line)]


def all_hits() -> list[Hit]:
    """Forbidden words in the packages, the documents and the README."""
    sources = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
    documents = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    found = [hit for path in sources for hit in hits_in_source(path)]
    return found + [hit for path in documents for hit in hits_in_document(path)]


if __name__ == "__main__":
    for one in all_hits():
        print(one)
