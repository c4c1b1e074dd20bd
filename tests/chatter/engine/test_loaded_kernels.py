"""Compiled code from the disk gives the same answers, and others can be linked to it."""

import json
import os
import subprocess
import sys

import pytest

KERNELS = '''
import json
import sys

import numpy as np
from numba import njit

from chatter.engine.presets import KERNEL


@njit(**KERNEL)
def mean_of_products(first, second):
    """Allocates, calls the matrix product and raises."""
    if first.shape[1] != second.shape[0]:
        raise ValueError("shapes")
    product = first @ second
    return np.sort(product.ravel()), product.sum() / product.size


@njit(**KERNEL)
def twice(first, second):
    """Calls a function that has an entry of its own."""
    return 2.0 * mean_of_products(first, second)[1]


matrix = np.arange(6.0).reshape(2, 3)
calls = {"first": mean_of_products, "second": twice}
answers = {}
for name in sys.argv[1:]:
    answer = calls[name](matrix, matrix.T.copy())
    answers[name] = [part.tolist() if hasattr(part, "tolist") else part for part in np.atleast_1d(
        answer if name == "second" else answer[1])]
hits = {name: sum(calls[name].stats.cache_hits.values()) for name in sys.argv[1:]}
compiler = "numba.np.arraymath" in sys.modules
print(json.dumps({"answers": answers, "hits": hits, "compiler": compiler}))
try:
    mean_of_products(matrix, matrix)
except ValueError as error:
    assert str(error) == "shapes"
'''


@pytest.fixture
def run(tmp_path):
    module = tmp_path / "kernels.py"
    module.write_text(KERNELS, encoding="utf-8")

    def call(*names):
        done = subprocess.run(
            [sys.executable, str(module), *names],
            capture_output=True,
            text=True,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return call


def test_a_loaded_function_answers_as_the_compiled_one_and_needs_no_compiler(run):
    compiled, loaded = run("first"), run("first")
    # sum of the Gram matrix of rows (0 1 2) and (3 4 5): |(3, 5, 7)|^2 = 83, over four entries
    assert compiled["answers"]["first"] == loaded["answers"]["first"] == [83.0 / 4.0]
    assert compiled["hits"]["first"] == 0
    assert loaded["hits"]["first"] == 1
    assert compiled["compiler"]
    assert not loaded["compiler"]


def test_another_function_is_linked_to_a_loaded_one_and_kept(run):
    run("first")
    linked, loaded = run("first", "second"), run("first", "second")
    assert linked["hits"] == {"first": 1, "second": 0}
    assert loaded["hits"] == {"first": 1, "second": 1}
    assert linked["answers"] == loaded["answers"]
    assert linked["answers"]["second"] == [83.0 / 2.0]
