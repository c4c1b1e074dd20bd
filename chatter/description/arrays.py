"""Types of arrays, for annotations; their shapes stand beside them."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
IntegerArray: TypeAlias = NDArray[np.int64]
ComplexArray: TypeAlias = NDArray[np.complex128]
BooleanArray: TypeAlias = NDArray[np.bool_]
