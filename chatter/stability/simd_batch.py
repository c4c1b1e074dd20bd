"""Eight points at once: SIMD batches for compiled code.

Kernels over many small systems of one shape keep the systems in the last axis of their arrays and
calculate with batches as with plain numbers; an operation is one vector instruction where the
processor has such. What happens in a member never depends on the other batch.
"""

import operator

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

#: points that are treated together
BATCH_SIZE = 8

_VECTOR = ir.VectorType(ir.DoubleType(), BATCH_SIZE)
#: a product and a sum may be one instruction
_FLAGS = ("contract", "nsz")


class BatchType(types.Type):
    """Type of a number of eight batch in compiled code."""

    def __init__(self) -> None:
        super().__init__(name="Batch")


_BATCH = BatchType()


@register_model(BatchType)
class _BatchModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _VECTOR)


def _spread(builder, value):
    undefined = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    everywhere = ir.Constant(ir.VectorType(ir.IntType(32), BATCH_SIZE), [0] * BATCH_SIZE)
    return builder.shuffle_vector(first, undefined, everywhere)


class _Arithmetic(AbstractTemplate):
    """Batches with batches, or with a plain number."""

    def generic(self, args, kws):  # noqa: ARG002
        known = all(kind == _BATCH or isinstance(kind, types.Float) for kind in args)
        if len(args) == 2 and known and _BATCH in args:
            return signature(_BATCH, *args)
        return None


def _provide(instruction, *operators):
    def lower(context, builder, sig, args):
        values = [
            value
            if kind == _BATCH
            else _spread(builder, context.cast(builder, value, kind, types.float64))
            for value, kind in zip(args, sig.args, strict=True)
        ]
        return getattr(builder, instruction)(*values, flags=_FLAGS)

    for known in operators:
        infer_global(known)(type("_Operator", (_Arithmetic,), {"key": known}))
        lower_builtin(known, BatchType, BatchType)(lower)
        lower_builtin(known, BatchType, types.Float)(lower)
        lower_builtin(known, types.Float, BatchType)(lower)


_provide("fadd", operator.add, operator.iadd)
_provide("fsub", operator.sub, operator.isub)
_provide("fmul", operator.mul, operator.imul)
_provide("fdiv", operator.truediv, operator.itruediv)


def _pointer(context, builder, kinds, values):
    """Address of the batch at an index of all axes but the last."""
    array_kind, index_kind = kinds
    array, index = values
    if isinstance(index_kind, types.BaseTuple):
        parts, part_kinds = cgutils.unpack_tuple(builder, index), list(index_kind)
    else:
        parts, part_kinds = [index], [index_kind]
    positions = [
        context.cast(builder, part, kind, types.intp)
        for part, kind in zip(parts, part_kinds, strict=True)
    ]
    positions.append(context.get_constant(types.intp, 0))
    # what only compilation needs is not imported where the compiled code is on the disk
    from numba.np.arrayobj import make_array

    whole = make_array(array_kind)(context, builder, array)
    address = cgutils.get_item_pointer(
        context, builder, array_kind, whole, positions, wraparound=False
    )
    return builder.bitcast(address, _VECTOR.as_pointer())


@intrinsic
def load(typingctx, array, index):  # noqa: ARG001
    """Batches of an array (..., 8) at an index of the axes before the last."""

    def code(context, builder, sig, args):
        return builder.load(_pointer(context, builder, sig.args, args), align=8)

    return _BATCH(array, index), code


@intrinsic
def store(typingctx, array, index, value):  # noqa: ARG001
    """Set the batch of an array (..., 8) at an index of the axes before the last."""

    def code(context, builder, sig, args):
        builder.store(args[2], _pointer(context, builder, sig.args[:2], args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), code


@intrinsic
def spread(typingctx, value):  # noqa: ARG001
    """Return a batch that holds everywhere the same plain number."""

    def code(context, builder, sig, args):  # noqa: ARG001
        return _spread(builder, args[0])

    return _BATCH(types.float64), code
