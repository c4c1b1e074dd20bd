"""Walls between the packages, light imports, and the cache of compiled code."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import grimp
import numpy as np
import pytest
import scipy.sparse
import tomlkit
from scipy.sparse.csgraph import connected_components

from tests.cases import TOOL_OF_922_HERTZ
from tests.places import ROOT

#: what kernels and physics know nothing of
FOREIGN = {"chatter", "matplotlib", "pint", "pydantic", "typer", "rich", "tomlkit"}
HEAVY = ["numba", "scipy", "numpy", "matplotlib", "pint", "pydantic", "tomlkit", "typer", "rich"]

#: decorators of kernels
COMPILED = {"njit", "register_jitable", "overload", "leaf"}
#: arguments that a function may take which is no kernel
MOST_ARGUMENTS = 8
#: text that may be a call which runs code
RUNS_CODE = re.compile(r"\b(eval|exec|__import__)\b|(?<!\.)\bcompile\b")

CASE = tomlkit.parse(TOOL_OF_922_HERTZ).unwrap()


def modules(package):
    return sorted((ROOT / package).rglob("*.py"))


@cache
def imported(path):
    """Full names of all modules that a file imports, wherever in it."""
    names = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names += [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return names


@pytest.mark.parametrize(
    ("package", "others"), [("dynamics", {"cutting"}), ("cutting", {"dynamics"})]
)
def test_machine_and_cutting_know_nothing_of_each_other(package, others):
    assert len(modules(package)) > 3
    for path in modules(package):
        names = {name.split(".")[0] for name in imported(path)}
        # units are read where files are read, and nowhere else
        allowed = {"pint"} if path.parent.name == "formats" else set()
        assert not names & (FOREIGN - allowed | others), path


def test_kernels_know_nothing_of_units_files_and_pictures():
    compiled = [p for p in modules("chatter/stability") if "chatter.engine.presets" in imported(p)]
    assert len(compiled) > 10
    for path in compiled:
        for name in imported(path):
            assert name.split(".")[0] not in FOREIGN - {"chatter"}, (path, name)
            layers = ("chatter.stability", "chatter.engine")
            known = [f"chatter.description.{one}" for one in ("arrays", "errors", "progress")]
            inside = name.startswith((*layers, *known))
            assert inside or not name.startswith("chatter"), (path, name)


def test_no_module_is_reached_from_itself():
    """No circle of imports; what is imported for types alone does not count."""
    graph = grimp.build_graph(
        "chatter", "cutting", "dynamics", exclude_type_checking_imports=True, cache_dir=None
    )
    names = sorted(graph.modules)
    number = {name: index for index, name in enumerate(names)}
    pairs = [
        (number[name], number[other])
        for name in names
        for other in graph.find_modules_directly_imported_by(name)
        if not other.startswith(f"{name}.")  # a package names its parts
    ]
    links = scipy.sparse.csr_array(
        (np.ones(len(pairs)), tuple(np.transpose(pairs))), shape=(len(names), len(names))
    )
    count, circle = connected_components(links, connection="strong")
    of_circle = [[names[i] for i in np.flatnonzero(circle == one)] for one in range(count)]
    assert [members for members in of_circle if len(members) > 1] == []


def test_pictures_are_drawn_in_one_place():
    for path in modules("chatter"):
        if path.parent.name != "plots":
            lines = path.read_text(encoding="utf-8").splitlines()
            found = [line for line in lines if "matplotlib" in line and "import" in line]
            # for a type, never at import
            assert all(line.startswith("    from matplotlib.figure") for line in found), path


def test_no_code_is_taken_from_files():
    for package in ("chatter", "cutting", "dynamics"):
        for path in modules(package):
            text = path.read_text(encoding="utf-8")
            if RUNS_CODE.search(text):
                called = {
                    node.func.id
                    for node in ast.walk(ast.parse(text))
                    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
                }
                assert not called & {"eval", "exec", "compile", "__import__"}, path
            names = {name.split(".")[0] for name in imported(path)}
            assert not names & {"pickle", "shelve", "marshal", "dill"}, path
            assert "allow_pickle=True" not in text, path


def test_modules_are_small():
    for package in ("chatter", "cutting", "dynamics"):
        for path in modules(package):
            assert len(path.read_text(encoding="utf-8").splitlines()) < 600, path


def is_kernel(function, targets):
    """Whether numba compiles a function, or it stands for one that an overload compiles."""
    decorators = [d.func if isinstance(d, ast.Call) else d for d in function.decorator_list]
    names = {decorator.id for decorator in decorators if isinstance(decorator, ast.Name)}
    return bool(names & COMPILED) or function.name in targets


def functions_outside_kernels(tree):
    """Functions of a module; not kernels, and not what is defined in them."""
    targets = {
        node.args[0].id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "overload"
        and isinstance(node.args[0], ast.Name)
    }
    waiting = [tree]
    while waiting:
        for node in ast.iter_child_nodes(waiting.pop()):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                if is_kernel(node, targets):
                    continue
                yield node
            waiting.append(node)


def test_functions_outside_kernels_have_few_arguments():
    seen, long = 0, []
    for package in ("chatter", "cutting", "dynamics"):
        for path in modules(package):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            for function in functions_outside_kernels(tree):
                given = function.args
                count = len([*given.posonlyargs, *given.args, *given.kwonlyargs])
                seen += 1
                if count > MOST_ARGUMENTS:
                    long.append(f"{path.relative_to(ROOT)}: {function.name} takes {count}")
    assert seen > 1000
    assert not long, long


def python(code, **variables):
    """Run code in a fresh interpreter; return what it prints, as JSON."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**os.environ, **variables},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def loaded_by(statement):
    code = f"import json, sys\n{statement}\nprint(json.dumps(sorted(sys.modules)))"
    return {name for name in python(code) if "." not in name}


def test_import_is_light():
    assert not loaded_by("import chatter; dir(chatter)") & set(HEAVY)


def test_reading_a_case_needs_no_compiler_and_no_pictures():
    names = loaded_by("import chatter; chatter.load; import chatter.cli")
    assert "pydantic" in names
    assert not names & {"numba", "scipy", "matplotlib", "pint"}
    read = f"import chatter; chatter.Case.from_dict({CASE!r})"
    assert not loaded_by(read) & {"numba", "matplotlib"}


def test_whoever_compiles_has_the_leaves_of_laws():
    """They wait for the modules named here, and would be unknown to numba without them."""
    known = {"cutting.compiled", "dynamics.compiled", "chatter.engine.presets"}
    compiling = 0
    for package in ("chatter", "cutting", "dynamics"):
        for path in modules(package):
            names = set(imported(path))
            if path.name != "compiled.py" and any(name.endswith(".njit") for name in names):
                compiling += 1
                assert names & known, path
    assert compiling > 10


def test_stability_needs_no_pictures():
    assert "matplotlib" not in loaded_by("import chatter; chatter.lobes; chatter.check")


@pytest.fixture
def sources(tmp_path):
    for package in ("chatter", "cutting", "dynamics"):
        for path in modules(package):
            copied = tmp_path / path.relative_to(ROOT)
            copied.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copied)
    return tmp_path


def test_cache_folder_changes_with_every_source(sources):
    from chatter.engine.presets import CACHE_FOLDER, source_hash

    first = source_hash(sources)
    assert CACHE_FOLDER.name == f"kernels-{first}"
    seen = {first}
    for name in (
        "cutting/force/directional_coefficients.py",
        "dynamics/modal/modes.py",
        "chatter/stability/methods/collocation/drivers.py",
    ):
        path = sources / name
        text = path.read_text(encoding="utf-8")
        path.write_text(text + "\n# edited\n", encoding="utf-8")
        seen.add(source_hash(sources))
        path.write_text(text, encoding="utf-8")
        assert source_hash(sources) == first
    assert len(seen) == 4
    (sources / "cutting/force/directional_coefficients.py").rename(sources / "cutting/renamed.py")
    assert source_hash(sources) not in seen


def test_layers_above_compiled_code_leave_the_cache_alone(sources):
    """An edit of a command or a picture compiles nothing anew; these layers have no kernel."""
    from chatter.engine.presets import ABOVE_COMPILED, source_hash

    first = source_hash(sources)
    kernel = re.compile(r"^\s*@(\w+\.)?(njit|jit|leaf|overload)\b", re.MULTILINE)
    for layer in ABOVE_COMPILED:
        path = sources / "chatter" / layer / "__init__.py"
        path.write_text(path.read_text(encoding="utf-8") + "\n# edited\n", encoding="utf-8")
        for module in (sources / "chatter" / layer).rglob("*.py"):
            assert not kernel.search(module.read_text(encoding="utf-8")), module
    assert source_hash(sources) == first


@pytest.mark.parametrize("library", ["numba", "llvmlite", "numpy", "scipy"])
def test_cache_folder_changes_with_every_library(monkeypatch, library):
    from chatter.engine import presets

    first, installed = presets.source_hash(ROOT), presets.version
    newer = {library: f"{installed(library)}.post1"}
    monkeypatch.setattr(presets, "version", lambda name: newer.get(name) or installed(name))
    assert presets.source_hash(ROOT) != first


def test_a_check_loads_no_more_than_it_needs():
    check = (
        "import json, sys, chatter\n"
        "chatter.check('examples/one-degree-of-freedom/case.toml').summary()\n"
        "print(json.dumps(sorted(sys.modules)))"
    )
    # the first time it may have to compile
    python(check)
    loaded = python(check)
    slow = {"pint", "dask", "matplotlib", "scipy.optimize", "scipy.linalg", "scipy.interpolate"}
    assert not slow & set(loaded)
    assert not [name for name in loaded if name.startswith("chatter.description.machine")]


def test_an_edited_leaf_is_compiled_anew(sources):
    """The leaf lives in another file than the cached driver, where numba does not look."""
    code = (
        "import json, sys\n"
        "sys.path.insert(0, sys.argv[1] if len(sys.argv) > 1 else '.')\n"
        "from chatter.engine.presets import CACHE_FOLDER\n"
        "print(json.dumps(str(CACHE_FOLDER)))"
    )
    base = sources / "cache"

    def folder():
        done = subprocess.run(
            [sys.executable, "-c", code, str(sources)],
            capture_output=True,
            text=True,
            cwd=sources,
            env={**os.environ, "NUMBA_CACHE_DIR": str(base)},
            check=True,
        )
        return json.loads(done.stdout)

    first = folder()
    assert Path(first).parent == base
    assert folder() == first
    leaf = sources / "cutting/force/linear.py"
    leaf.write_text(leaf.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    assert folder() != first


def test_other_values_and_counts_compile_nothing_new():
    from chatter import Case
    from chatter.stability.methods.semi_discretization.arrays import milling_arrays
    from chatter.stability.methods.semi_discretization.drivers import multipliers_at
    from chatter.stability.methods.semi_discretization.multipliers import multipliers
    from chatter.stability.model import milling_model

    case = Case.from_dict(CASE)
    second = {
        "frequency": "700 Hz", "damping": 0.02, "stiffness": "2 N/um", "direction": [0, 1, 0]
    }  # fmt: skip
    third = {**second, "direction": [0.6, 0.0, 0.8], "side": "workpiece"}
    patches = [
        {},
        {"tool.teeth": 5, "tool.helix": "30 deg", "cut.mode": "up"},
        {"structure.mode[1]": second},
        {"structure.mode[1]": second, "structure.mode[2]": third},
        {"process_damping.coefficient": "0.2 N/mm", "cut.mode": "slot", "cut.radial_depth": None},
        {"material": {"law": "exponential", "Ktc": 6e8, "h0": 1e-4, "exponent": 0.7}},
    ]
    known = None
    for values in patches:
        patched = case.patch(values)
        point = (
            np.array([value]) for value in (patched.cut.spindle_speed, patched.cut.axial_depth)
        )
        value = multipliers(milling_arrays(milling_model(patched)), *point, 24)
        assert abs(value[0]) > 0.0
        # other tests of the process may have called it with other schemes and read-only arrays
        known = known or set(multipliers_at.signatures)
        assert set(multipliers_at.signatures) == known


MULTIPLIER = """
import json, sys
import numpy as np
from chatter import Case
from chatter.stability.model import milling_model
from chatter.stability.methods.semi_discretization.arrays import milling_arrays
from chatter.stability.methods.semi_discretization.drivers import multipliers_at
from chatter.stability.methods.semi_discretization.step_schemes import FIRST_ORDER
case = Case.from_dict(json.loads({case!r}))
arrays = milling_arrays(milling_model(case))
point = [np.array([float(v)]) for v in (case.cut.spindle_speed, case.cut.axial_depth)]
value = multipliers_at(FIRST_ORDER, arrays, *point, np.array([16]), 1, np.array([1]))[0][0]
print(json.dumps([value.real, value.imag]))
"""


def test_without_the_compiler_the_multiplier_is_the_same():
    code = MULTIPLIER.format(case=json.dumps(CASE))
    compiled = complex(*python(code))
    plain = complex(*python(code, NUMBA_DISABLE_JIT="1"))
    assert abs(compiled) > 0.1
    assert plain == pytest.approx(compiled, abs=1e-12)


def test_leaves_of_both_packages_are_compiled_alike():
    """Neither package may know the other, so that both have the presets and the dispatch."""
    from chatter.engine import presets
    from cutting import compiled

    for module in ("compiled.py", "keys.py", "leaves.py"):
        text = [(ROOT / package / module).read_text() for package in ("cutting", "dynamics")]
        assert text[0] == text[1].replace("from dynamics.", "from cutting."), module
    assert compiled.UNCOUNTED.items() <= presets.TIME_LOOP.items()
    for package in ("chatter", "cutting", "dynamics"):
        for path in modules(package):
            if path.name not in ("leaves.py", "presets.py"):
                assert "_nrt" not in path.read_text(encoding="utf-8"), path
