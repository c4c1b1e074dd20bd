"""Settings for all tests."""

import gc
import os

import pytest
from hypothesis import settings

from tests.nightly_tests import nightly_tests

# matrices in the tests are small: threads of BLAS cost more than they bring
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# what compilers and modules leave stays: to look through it again and again takes a tenth of a run
gc.set_threshold(50_000, 10, 10)

# a gate repeats itself: it draws the same cases every time, the nightly run draws new ones; on a
# machine that is busy a case may take any time
settings.register_profile("gate", derandomize="CHATTER_PROPERTIES" not in os.environ, deadline=None)
settings.load_profile("gate")


def pytest_configure(config):
    """Workers share what they compile."""
    if hasattr(config, "workerinput"):
        from tests.shared_compilation import compile_once

        compile_once()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark the slow tests of the list, and nightly tests in a report, which makes their record.

    First, as the marks choose what is run.
    """
    slow = nightly_tests()
    for item in items:
        if item.nodeid in slow:
            item.add_marker("nightly")
        if item.get_closest_marker("nightly"):
            item.user_properties.append(("nightly", True))
