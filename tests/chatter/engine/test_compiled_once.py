"""Functions without an entry are compiled as parts of what calls them, with the same answers."""

import ctypes
import os
import subprocess
import sys

import numpy as np
import pytest
from numba import njit
from numba.core.compiler_lock import global_compiler_lock

from chatter.engine.presets import INNER_KERNEL, KERNEL, LEAF_KERNEL


@njit(**LEAF_KERNEL)
def square(x):
    return x * x


@njit(**INNER_KERNEL)
def squares(values):
    out = np.empty(values.size)
    for i in range(values.size):
        if values[i] < 0.0:
            raise ValueError("negative")
        out[i] = square(values[i])
    return out


@njit(**{**KERNEL, "cache": False})
def sum_of_squares(values):
    return squares(values).sum()


def compiled(function):
    (overload,) = function.overloads.values()
    return overload


def test_two_levels_of_parts_give_what_their_driver_asks_for():
    assert sum_of_squares(np.array([1.0, 2.0, 3.0])) == 14.0


def test_an_exception_goes_through_a_part():
    with pytest.raises(ValueError, match="negative"):
        sum_of_squares(np.array([1.0, -2.0]))


def test_a_part_has_no_machine_code_until_its_address_is_wanted():
    sum_of_squares(np.array([1.0]))
    part = compiled(square)
    with global_compiler_lock:
        address_of = part.library.get_pointer_to_function
        assert address_of(part.fndesc.llvm_cpython_wrapper_name) == 0
        address = address_of(part.fndesc.llvm_func_name)
    # as numba calls: place of the result, place of an exception, arguments
    kind = ctypes.CFUNCTYPE(
        ctypes.c_int,
        ctypes.POINTER(ctypes.c_double),
        ctypes.POINTER(ctypes.c_void_p),
        ctypes.c_double,
    )
    result, exception = ctypes.c_double(), ctypes.c_void_p()
    assert kind(address)(ctypes.byref(result), ctypes.byref(exception), 5.0) == 0
    assert result.value == 25.0


def test_functions_of_others_have_entries_as_ever():
    @njit
    def cube(x):
        return x * square(x)

    assert cube(3.0) == 27.0


def test_a_driver_is_taken_from_the_disk_with_its_parts(tmp_path):
    module = tmp_path / "kernels.py"
    module.write_text(
        "import numpy as np\n"
        "from numba import njit\n"
        "from chatter.engine.presets import INNER_KERNEL, KERNEL\n"
        "@njit(**INNER_KERNEL)\n"
        "def positive(x):\n"
        "    if x < 0.0:\n"
        "        raise ValueError('negative')\n"
        "    return x\n"
        "@njit(**KERNEL)\n"
        "def doubled(x):\n"
        "    return 2.0 * positive(x)\n"
        "print(doubled(1.5), sum(doubled.stats.cache_hits.values()))\n"
        "try:\n"
        "    doubled(-1.0)\n"
        "except ValueError as error:\n"
        "    print(error)\n",
        encoding="utf-8",
    )
    said = [
        subprocess.run(
            [sys.executable, str(module)],
            capture_output=True,
            text=True,
            env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
            check=True,
        ).stdout.split()
        for _ in range(2)
    ]
    assert said == [["3.0", "0", "negative"], ["3.0", "1", "negative"]]
