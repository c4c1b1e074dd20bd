"""Settings for all tests."""

import os

from hypothesis import settings

# matrices in the tests are small: threads of BLAS cost more than they bring
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# a gate repeats itself: it draws the same cases every time, and the nightly run draws new ones
settings.register_profile("gate", derandomize="CHATTER_PROPERTIES" not in os.environ)
settings.load_profile("gate")
