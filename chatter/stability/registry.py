"""The stability methods, and which one a case takes."""

from chatter.description.case import Case
from chatter.description.errors import InputError
from chatter.description.formatting import formatted
from chatter.description.given_values import text_given
from chatter.description.registry import Registry
from chatter.stability.methods.collocation.collocation_method import COLLOCATION
from chatter.stability.methods.matrix_free.matrix_free_method import MATRIX_FREE
from chatter.stability.methods.multi_frequency.multi_frequency_method import MULTI_FREQUENCY
from chatter.stability.methods.semi_discretization import semi_discretization_method
from chatter.stability.methods.time_domain.time_domain_method import TIME_DOMAIN
from chatter.stability.methods.zeroth_order.zeroth_order_method import ZEROTH_ORDER
from chatter.stability.stability_method import StabilityMethod

METHODS: Registry[StabilityMethod] = Registry(
    group="chatter.stability_methods",
    what="stability method",
    built_in=(
        COLLOCATION,
        semi_discretization_method.FIRST_ORDER,
        semi_discretization_method.ZEROTH_ORDER,
        semi_discretization_method.SECOND_ORDER,
        semi_discretization_method.FULL_DISCRETIZATION,
        MATRIX_FREE,
        MULTI_FREQUENCY,
        ZEROTH_ORDER,
        TIME_DOMAIN,
    ),
)
#: chooses among them
AUTO = "auto"


def chosen_method(case: Case, name: str | None = None) -> StabilityMethod:
    """The method as asked for, else as the case says, else the best.

    ``"auto"`` takes collocation, semi-discretization where the case fixes its steps, and the
    matrix-free method where tool and work have a contact, which it alone of the linear ones takes.

    InputError if there is no such method.
    """
    given = None if name is None else text_given(name, "the name of a method")
    name = given or (case.lobes.method if case.lobes else None) or AUTO
    if name == AUTO:
        name = "collocation" if case.contact is None else "matrix-free"
        name = name if fixed_steps(case) is None else "semi-discretization"
    if name not in METHODS:
        where = "" if given else f"{case.name}: lobes.method: "
        raise InputError(f"{where}{METHODS.unknown(name)}; {formatted(AUTO)} chooses")
    return METHODS[name]


def with_radius(method: StabilityMethod) -> StabilityMethod:
    """The method where it gives the spectral radius, else collocation."""
    return method if method.gives_radius else COLLOCATION


def with_multiplier(method: StabilityMethod) -> StabilityMethod:
    """The method where it gives the multiplier of a cut, else collocation."""
    return method if method.gives_multiplier else COLLOCATION


def with_chatter_frequency(method: StabilityMethod) -> StabilityMethod:
    """The method where it gives the chatter frequency of a cut, else collocation."""
    return method if method.gives_chatter_frequency else COLLOCATION


def fixed_steps(case: Case) -> int | None:
    """Steps per tooth period that the case fixes; None leaves them to the method."""
    return case.lobes.steps if case.lobes else None


def documentation() -> str:
    """Return the table of the methods as it stands in the docs."""
    takes = (
        ("takes_any_tool", "any tool"),
        ("takes_varying_speed", "varying speed"),
        ("takes_process_damping", "process damping"),
        ("takes_contact", "contact"),
        ("takes_frfs", "FRFs without a fit"),
    )
    rows = [
        "| method | takes | spectral radius | what it is and what it is for |",
        "|---|---|---|---|",
    ]
    for method in METHODS:
        taken = ", ".join(word for key, word in takes if getattr(method, key))
        radius = "yes" if method.gives_radius else "by collocation"
        rows.append(f"| `{method.name}` | {taken} | {radius} | {method.help} |")
    return "\n".join(rows) + "\n"
