"""Contact of tool and workpiece while the tool is in the cut, as a spring and a damper."""

from typing import NamedTuple

from numba.extending import register_jitable

from cutting.compiled import INLINED


class ToolContact(NamedTuple):
    """Spring and damper in the plane of the cut, in both directions alike.

    They act as far as the tool is in the cut: in proportion to the engaged share of the depth of
    cut, and whole from `full_engagement_share` on; near 0, as soon as any edge cuts. The group
    comes after the cut that it belongs to.
    Suzuki et al. (coupled simulation with friction and process damping, figure 7) identify such a
    pair from the frequency response in the cut.
    """

    stiffness: float  # N/m
    damping: float  # N s/m
    full_engagement_share: float  # engaged share of the depth of cut, 1


@register_jitable(**INLINED)
def contact_forces(group, rotation, point):  # noqa: ARG001
    """Add the force of the contact on the tool."""
    share = min(1.0, point.contact[0] / group.full_engagement_share)
    for axis in range(2):
        force = -share * (
            group.stiffness * point.displacement[axis] + group.damping * point.velocity[axis]
        )
        point.force[axis] += force
        point.sample[axis] += force


@register_jitable(**INLINED)
def contact_commit(group, rotation, point):
    """Remember nothing: the contact has no memory."""
