"""Case: a form made from the schema with its TOML beside it, each following the other."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn
import tomlkit

import chatter
from chatter.app.workbench.form_fields import (
    FormField,
    fields_of,
    label_in_list,
    new_entries,
    sections,
    typed,
    written,
)
from chatter.app.workbench.result_panel import CODE
from chatter.app.workbench.session import Session
from chatter.app.workbench.wrapped_text import wrapped_text
from chatter.description.errors import InputError
from chatter.first_steps.first_case import QUESTIONS, Question, first_case
from cutting.material.table import MATERIALS

#: the table of materials is longer than a window
_BOUNDED_LIST = ".bk-menu {max-height: 300px; overflow-y: auto}"
_ERROR = {"color": "#c62828", "font-size": "12px"}
_PATH = re.compile(r"^([A-Za-z_][\w.\[\]-]*): (.*)$", re.DOTALL)
#: section of friction laws with names, and the one that has the fewest keys
_FRICTION, _DRY = "friction", "coulomb-stribeck"
_FIRST = ("tool", "material", "cut", "structure")


class CaseView:
    """The open case as a form and as text.

    Parameters
    ----------
    session : Session
    opened : callable
        Called with its name when a case was made or saved under another name.
    """

    def __init__(self, session: Session, opened: Callable[[str], None] = lambda _: None) -> None:
        self._session, self._opened = session, opened
        self._schema = chatter.schema()
        self.fields: dict[str, FormField] = {}
        self.widgets: dict[str, Any] = {}
        self.errors: dict[str, pn.pane.Str] = {}
        self._following = False
        self.text = pn.widgets.TextAreaInput(
            label="TOML", width=560, height=760, max_length=1_000_000,
            styles={"font-family": "monospace"},
            stylesheets=["textarea {font-family: monospace; font-size: 12.5px; white-space: pre}"],
        )  # fmt: skip
        self.message = wrapped_text(width=560, styles=_ERROR)
        self.done = pn.pane.Str("", width=560)
        self.call = wrapped_text(width=560, styles=CODE)
        self.save_button = pn.widgets.Button(label="Save", color="primary", width=110, align="end")
        self.save_name = pn.widgets.TextInput(label="Save as", placeholder="case-2.toml", width=200)
        self.section = pn.widgets.Select(label="Add a section", options=[], width=200)
        self.add_button = pn.widgets.Button(label="Add", width=80, align="end")
        self._form = pn.Column(width=560)
        self.new = NewCase(session, self._made)
        self.text.param.watch(lambda event: self._typed_text(event.new), "value")
        self.save_button.on_click(lambda _: self.save())
        self.add_button.on_click(lambda _: self.add(self.section.value))
        session.watch(self.follow)
        self.follow()

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the view for the page."""
        return pn.Column(
            self.new,
            pn.Row(
                pn.Column(
                    pn.Row(self.save_name, self.save_button),
                    self.done,
                    pn.Row(self.section, self.add_button),
                    self._form,
                ),
                pn.Column(self.message, self.text, self.call),
            ),
        )

    def refresh(self) -> None:
        """Look again at what has come into the folder."""
        self.new.refresh()

    def follow(self) -> None:
        """Show the open case: in the form as far as its text is TOML, and as text."""
        self._following = True
        try:
            self.text.value = self._session.text
            content = self._content()
            if content is not None:
                self._fill(content)
            self._show_problems()
            name = self._session.name
            self.call.object = f"chatter check {name}\nchatter.load({name!r})" if name else ""
        finally:
            self._following = False

    def enter(self, path: str, text: str) -> None:
        """Type a text into a field of the form, by its path."""
        self.widgets[path].value = text

    def add(self, name: str | None) -> None:
        """Add a section, or one more table of a list, by its name."""
        content = self._content()
        if not name or content is None:
            return
        offered = self._offered(content)
        try:
            self._session.set_values(offered[name])
        except InputError as error:
            self.message.object = self._session.short(error)

    def save(self) -> None:
        """Save the case, under another name where one is given."""
        try:
            self._session.save(self.save_name.value.strip())
        except InputError as error:
            self.done.object = ""
            self.message.object = self._short(error.messages)
            return
        self.save_name.value = ""
        self.done.object = f"{self._session.name} is saved"
        self._opened(self._session.name)

    def _made(self, name: str) -> None:
        self.done.object = f"{name} is made and saved"
        self._opened(name)

    def _typed_text(self, text: str) -> None:
        if not self._following and text != self._session.text:
            self.done.object = ""
            self._session.set_text(text)

    def _entered(self, path: str, text: str) -> None:
        if self._following:
            return
        self.done.object = ""
        try:
            self._session.set_values([(path, typed(self.fields[path], text))])
        except InputError as error:
            self.errors[path].object = str(error)

    def _content(self) -> dict[str, Any] | None:
        try:
            return tomlkit.parse(self._session.text).unwrap()
        except Exception:  # of several kinds: the message of the session says what
            return None

    def _offered(self, content: dict[str, Any]) -> dict[str, list[tuple[str, Any]]]:
        """What may be added: label -> values to be set by path."""
        found: dict[str, list[tuple[str, Any]]] = {}
        for name in sections(self._schema):
            if name == _FRICTION:
                found |= _frictions_of_modes(content)
                continue
            if name not in content and self._schema["properties"][name].get("type") != "array":
                found[name] = [(name, {})]
            for label, path in new_entries(self._schema, name, content).items():
                if name in content or label == name:
                    found[f"{name}: one more {label}" if label != name else label] = [(path, {})]
        return found

    def _fill(self, content: dict[str, Any]) -> None:
        present = [name for name in sections(self._schema) if name in content]
        first = [name for name in _FIRST if name in present]
        ordered = [*first, *(name for name in present if name not in first)]
        by_section = {name: fields_of(self._schema, name, content) for name in ordered}
        title = FormField("title", "title", "", "", (), True)
        fields = {one.path: one for listed in by_section.values() for one in listed}
        fields = {"title": title, **fields}
        if not self._session.name:
            fields, by_section = {}, {}
        if set(fields) != set(self.fields):
            self.fields = fields
            self._build(by_section, content)
        for path in self.widgets:
            value = written(content, path)
            if self.widgets[path].value != value:
                self._put(path, value)
        offered = list(self._offered(content)) if self._session.name else []
        self.section.options = offered
        if self.section.value not in offered:
            self.section.value = next(iter(offered), None)

    def _put(self, path: str, value: str) -> None:
        widget = self.widgets[path]
        if isinstance(widget, pn.widgets.Select) and value not in widget.options:
            widget.options = [*widget.options, value]
        widget.value = value

    def _build(self, by_section: dict[str, list[FormField]], content: dict[str, Any]) -> None:
        self.widgets, self.errors = {}, {}
        faulty = {path for path, _ in self._problems_by_path()}
        parts: list[Any] = [self._row(self.fields["title"])] if self.fields else []
        for name, listed in by_section.items():
            given = [one for one in listed
                     if written(content, one.path) or one.path in faulty]  # fmt: skip
            rest = [one for one in listed if one not in given]
            # of a section that is new, the first few are what it mostly needs
            shown, hidden = (given, rest) if given else (rest[:6], rest[6:])
            body = [self._row(one) for one in shown]
            if hidden:
                body.append(pn.Card(*(self._row(one) for one in hidden), title="further keys",
                                    collapsed=True, width=520))  # fmt: skip
            is_open = name in _FIRST or any(one.path in faulty for one in listed)
            parts.append(pn.Card(*body, title=name.replace("_", " "), width=550,
                                 collapsed=not is_open))  # fmt: skip
        self._form.objects = parts

    def _row(self, field: FormField) -> pn.Column:
        """Field with its error beside it."""
        label = label_in_list(field.path) if "[" in field.path else field.label
        options: dict[str, Any] = {"label": label, "width": 240}
        if field.description:
            options["description"] = field.description
        if field.options:
            widget = pn.widgets.Select(options=["", *field.options], **options)
        else:
            widget = pn.widgets.TextInput(placeholder=field.example, **options)
        widget.param.watch(lambda event: self._entered(field.path, event.new), "value")
        error = wrapped_text(width=260, styles=_ERROR)
        self.widgets[field.path], self.errors[field.path] = widget, error
        return pn.Row(widget, error)

    def _problems_by_path(self) -> list[tuple[str, str]]:
        """Faults of the case, each with the path that it begins with, or without one."""
        found = []
        for told in self._session.problems:
            text = told.removeprefix(f"{self._session.name}: ")
            match = _PATH.match(text)
            found.append((match[1], match[2]) if match is not None else ("", text))
        return found

    def _show_problems(self) -> None:
        beside: dict[str, list[str]] = {}
        general = []
        for path, text in self._problems_by_path():
            if path in self.errors:
                beside.setdefault(path, []).append(text)
            else:
                general.append(f"{path}: {text}" if path else text)
        for path, error in self.errors.items():
            error.object = "\n".join(beside.get(path, ()))
        hidden = [f"{path}: {'; '.join(told)}" for path, told in beside.items()]
        self.message.object = "\n".join([*general, *hidden])

    def _short(self, messages: tuple[str, ...]) -> str:
        return self._session.short("\n".join(messages))


def _frictions_of_modes(content: dict[str, Any]) -> dict[str, list[tuple[str, Any]]]:
    """A dry friction for each mode without one: label -> values to be set by path."""
    modes = (content.get("structure") or {}).get("mode") or ()
    taken = content.get(_FRICTION) or {}
    found = {}
    for place, mode in enumerate(modes):
        name = f"mode_{place + 1}"
        if _FRICTION not in mode and name not in taken:
            found[f"friction: of mode {place + 1}"] = [
                (f"{_FRICTION}.{name}", {"law": _DRY}),
                (f"structure.mode[{place}].{_FRICTION}", name),
            ]
    return found


class NewCase:
    """A first case from five answers; the dynamics may come from the tap tests of the folder."""

    def __init__(self, session: Session, made: Callable[[str], None]) -> None:
        self._session, self._made = session, made
        self.answers = {name: _answer(name, one) for name, one in QUESTIONS.items()}
        self.name = pn.widgets.TextInput(label="File", value="case.toml", width=200)
        self.make = pn.widgets.Button(label="Make the case", color="primary", align="end")
        self.message = wrapped_text(width=860, styles=_ERROR)
        self.measured = wrapped_text()
        self.refresh()
        self._card = pn.Card(
            pn.FlexBox(*self.answers.values(), min_width=860),
            self.measured,
            pn.Row(self.name, self.make),
            self.message,
            title="New case", collapsed=bool(session.case_names()), width=920,
        )  # fmt: skip
        self.make.on_click(lambda _: self.create())

    def __panel__(self) -> pn.viewable.Viewable:
        """Return the form for the page."""
        return self._card

    def refresh(self) -> None:
        """Say which tap tests a case without an answer on its dynamics takes up."""
        names = ", ".join(path.name for path in self._mode_files())
        self.measured.object = (
            f"Dynamics left empty: the modes of {names}, as Tap test has written them."
            if names
            else "Dynamics: modes from Tap test are taken up here once there are any."
        )

    def create(self) -> None:
        """Make the case of the answers, save it and open it."""
        name = self.name.value.strip()
        try:
            self._write(name)
            self._session.open(name)
        except InputError as error:
            self.message.object = self._session.short(error)
            return
        self.message.object, self._card.collapsed = "", True
        self._made(name)

    def _write(self, name: str) -> None:
        """Write the file; InputError if an answer is missing or wrong."""
        draft = Session(self._session.root)
        answers = {key: one.value.strip() for key, one in self.answers.items()}
        measured = [] if answers["dynamics"] else self._measured_modes()
        if not answers["dynamics"] and not measured:
            raise InputError("dynamics: no answer, and no tap test has left modes-x.toml")
        if measured:
            answers["dynamics"] = QUESTIONS["dynamics"].example
        draft.start(name, first_case(answers, draft.root))
        if measured:
            draft.set_values([("structure.mode", None)])
            draft.set_modes(measured)
        draft.save()

    def _mode_files(self) -> list[Path]:
        return sorted(self._session.root.glob("modes-*.toml"))

    def _measured_modes(self) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        for path in self._mode_files():
            content = tomlkit.parse(path.read_text(encoding="utf-8")).unwrap()
            found += content.get("structure", {}).get("mode", [])
        return found


def _answer(name: str, question: Question) -> pn.widgets.Widget:
    """Field of an answer; a material is chosen from the table, or typed."""
    given = {"label": question.text, "placeholder": question.example, "width": 420}
    if name != "material":
        return pn.widgets.TextInput(**given)
    field = pn.widgets.AutocompleteInput(
        options=list(MATERIALS), restrict=False, min_characters=0,
        case_sensitive=False, search_strategy="includes", stylesheets=[_BOUNDED_LIST], **given,
    )  # fmt: skip
    field.param.watch(lambda _: _keep_what_was_typed(field), "value")
    return field


def _keep_what_was_typed(field: pn.widgets.AutocompleteInput) -> None:
    """Put back a text that is in no entry: as the field is left, it takes its first one.

    The list in the page is not brought up to date by a text that is pasted.
    """
    typed = (field.value_input or "").strip()
    if typed and typed.lower() not in (field.value or "").lower():
        field.value = typed
