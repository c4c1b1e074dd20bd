"""One thread of linear algebra while `explain` works.

Its matrices are tall and narrow, and its simulations fill the cores: threads of BLAS that wait for
each other took as much processor time as all the rest.
"""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

# a library that is loaded later would not be limited
import scipy.linalg  # noqa: F401

try:
    from threadpoolctl import threadpool_limits
except ImportError:  # installed before it was among the dependencies: slower, nothing else

    def threadpool_limits(**_: Any) -> nullcontext[None]:
        """Do without."""
        return nullcontext()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep BLAS to one thread within a block or a decorated function, and give back what was."""
    with threadpool_limits(limits=1, user_api="blas"):
        yield
