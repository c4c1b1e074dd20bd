"""Settings for all tests."""

import os

# matrices in the tests are small: threads of BLAS cost more than they bring
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
