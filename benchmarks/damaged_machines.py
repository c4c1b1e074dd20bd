"""Damaged machine and case files: every one has to end in an answer or in one clear refusal.

    python -m benchmarks.damaged_machines [count] [first seed]

Shipped files are damaged at one place each: a value times 1e300, 1e-300, 1e6 or 1e-6, zero,
negative, not a number, of another unit, of another type, missing, a count of a million. A machine
answers `frf` (linearised) and `move`, a case `check` by the zeroth-order solution and `simulate`
over a few revolutions. Each is run in a process of its own, forked when everything is compiled.
Printed is what ends otherwise than in an answer or a refusal that names the file: a fault of the
program, a refusal without a file, more than 10 s of processor time or more than 2 GB of memory
beyond what the program itself takes.
"""

import collections
import copy
import os
import pickle
import random
import resource
import signal
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import tomlkit

import chatter
from chatter.description.case import Case
from chatter.description.errors import InputError, RunError
from chatter.description.machine.machine_file import MachineFile
from chatter.simulation.virtual_tests.from_file import default_frfs, frfs

EXAMPLES = Path(__file__).parents[1] / "examples"
MACHINES = (
    "machine-gantry/machine.toml",
    "machine-coupled-milling/machine.toml",
    "machine-drive-control/machine.toml",
    "face-mill-chatter/machine.toml",
    "friction-amplitude/machine.toml",
)
CASES = (
    "one-degree-of-freedom/case.toml",
    "two-insert-cutter/case.toml",
    "chattering-cut/case.toml",
    "face-mill-chatter/case.toml",
    "friction-amplitude/case.toml",
)
#: processor time of an answer, s, and memory beyond that of the program, bytes
SECONDS, MEMORY = 10, 2 << 30
_GRACE = 60  # s of the clock, where other programs share the processor


def leaves(data: Any, path: tuple = ()) -> Iterator[tuple]:
    """Paths of all values of a file, those of tables and lists included."""
    if path:
        yield path
    if isinstance(data, dict):
        for key, value in data.items():
            yield from leaves(value, (*path, key))
    elif isinstance(data, list):
        for index, value in enumerate(data):
            yield from leaves(value, (*path, index))


def at(data: Any, path: tuple) -> Any:
    """Value at a path."""
    for key in path:
        data = data[key]
    return data


def scaled(factor: float) -> Callable[[Any], Any]:
    """Damage that multiplies a number or a quantity."""

    def damage(value: Any) -> Any:
        if isinstance(value, bool):
            return not value
        if isinstance(value, int):
            return int(value * factor) if abs(factor) < 1e10 else value * factor
        if isinstance(value, float):
            return value * factor
        if isinstance(value, str):
            number, _, unit = value.partition(" ")
            try:
                return f"{float(number) * factor:g} {unit}".strip()
            except ValueError:
                return value + value
        if isinstance(value, list):
            return [damage(part) for part in value]
        return value

    return damage


def other_unit(value: Any) -> Any:
    """Damage that writes another unit behind a number."""
    if isinstance(value, str) and " " in value:
        number, _, unit = value.partition(" ")
        swapped = {"mm": "m", "m": "mm", "N/um": "N/m", "kg": "g", "Hz": "kHz", "rpm": "1/s"}
        return f"{number} {swapped.get(unit, 'kg')}"
    return value


DAMAGES: dict[str, Callable[[Any], Any]] = {
    "times 1e300": scaled(1e300),
    "times 1e-300": scaled(1e-300),
    "times 1e6": scaled(1e6),
    "times 1e-6": scaled(1e-6),
    "times 1e12": scaled(1e12),
    "zero": scaled(0.0),
    "negative": scaled(-1.0),
    "not a number": lambda value: "nan",  # noqa: ARG005
    "words": lambda value: "as you like",  # noqa: ARG005
    "other unit": other_unit,
    "a list": lambda value: [value, value],
    "a table": lambda value: {"of": value},
    "a million": lambda value: 1_000_000,  # noqa: ARG005
    "many": lambda value: value * 20_000 if isinstance(value, list) else 10**9,
    "nothing": lambda value: "" if isinstance(value, str) else [],
}
MISSING = "missing"


def damaged(data: dict, chance: random.Random) -> tuple[dict, str]:
    """Copy of a file with one place damaged, and what was done."""
    path = chance.choice(list(leaves(data)))
    kind = chance.choice([*DAMAGES, MISSING])
    data = copy.deepcopy(data)
    table = at(data, path[:-1])
    if kind == MISSING:
        del table[path[-1]]
    else:
        table[path[-1]] = DAMAGES[kind](table[path[-1]])
    return data, f"{'.'.join(map(str, path))}: {kind}"


def answer_of_machine(data: dict, file: Path) -> None:
    """Linearised FRFs, then the first move."""
    machine = MachineFile.from_dict(data, name=file.name, folder=file.parent)
    sections = dict(machine.frf) or default_frfs(machine)
    linear = {name: one.model_copy(update={"by": "linearised"}) for name, one in sections.items()}
    frfs(machine, linear).summary()
    for name in list(machine.move)[:1]:
        chatter.move(machine, name).summary()


def answer_of_case(data: dict, file: Path) -> None:
    """Check by the zeroth-order solution, then a short simulation."""
    case = Case.from_dict(data, name=file.name, folder=file.parent)
    chatter.check(case, method="zero-order").summary()
    changes = {"simulation.duration": "0.2 s"}
    if case.simulation is not None and case.simulation.revolutions:
        changes = {"simulation.revolutions": min(case.simulation.revolutions, 10)}
    chatter.simulate(case.patch(changes)).summary()


def _report(answer: Callable[[], None], file: Path) -> str:
    """Run and put in words how it ended; empty where it is as it should be."""
    try:
        answer()
    except InputError as error:
        named = all(
            text.startswith(file.parent.name) or file.stem in text for text in error.messages
        )
        return "" if named else f"refusal without a file: {error}"
    except RunError:
        return ""
    except MemoryError:
        return "memory"
    except Exception as error:  # what is looked for
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"{type(error).__name__}: {error} ({Path(place.filename).name}:{place.lineno})"
    return ""


def outcome(answer: Callable[[], None], file: Path) -> str:
    """How an answer ends in a process of its own; empty where it is as it should be."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
        signal.alarm(_GRACE)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
        words = _report(answer, file)
        with os.fdopen(writing, "wb") as pipe:
            pickle.dump(words, pipe)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        said = pipe.read()
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        late = os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGALRM, signal.SIGKILL)
        return f"no answer within {SECONDS} s" if late else f"signal {os.WTERMSIG(status)}"
    return pickle.loads(said) if said else "ended without a word"


def main(arguments: list[str]) -> None:
    """Damage as many files as asked for and print what went wrong."""
    count = int(arguments[0]) if arguments else 300
    first = int(arguments[1]) if len(arguments) > 1 else 0
    warnings.simplefilter("ignore")
    sources = [(EXAMPLES / name, answer_of_machine) for name in MACHINES]
    sources += [(EXAMPLES / name, answer_of_case) for name in CASES]
    whole = {file: tomlkit.parse(file.read_text()).unwrap() for file, _ in sources}
    for file, answer in sources:
        answer(whole[file], file)  # compiles
        print(f"{file.relative_to(EXAMPLES)}: undamaged", flush=True)
    ended: collections.Counter[str] = collections.Counter()
    for seed in range(first, first + count):
        file, answer = sources[seed % len(sources)]
        data, what = damaged(whole[file], random.Random(seed))
        words = outcome(lambda answer=answer, data=data, file=file: answer(data, file), file)
        ended[words.partition(":")[0] or "as it should"] += 1
        if words:
            print(f"{seed} {file.parent.name}/{file.name} {what}\n    {words[:400]}", flush=True)
    print(", ".join(f"{number} {words}" for words, number in ended.most_common()))


if __name__ == "__main__":
    main(sys.argv[1:])
