"""Settings for all tests."""

import os

from hypothesis import settings

# matrices in the tests are small: threads of BLAS cost more than they bring
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# a gate repeats itself: it draws the same cases every time, and the nightly run draws new ones
settings.register_profile("gate", derandomize="CHATTER_PROPERTIES" not in os.environ)
settings.load_profile("gate")


def pytest_configure(config):
    """Workers share what they compile."""
    if hasattr(config, "workerinput"):
        from tests.compiled_once import compile_once

        compile_once()


def pytest_collection_modifyitems(items):
    """Mark nightly tests in a report, from which the record of a nightly run is made."""
    for item in items:
        if item.get_closest_marker("nightly"):
            item.user_properties.append(("nightly", True))
