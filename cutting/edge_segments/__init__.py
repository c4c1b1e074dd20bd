"""Edges of a tool as segments along their length, for the linear analysis of stability.

=================  =============================================================================
module             responsibility
=================  =============================================================================
segments           the table of segments, and their groups along which all is smooth
edge_profile       profile of the edge and heights at which segments border on each other
earlier_passes     which earlier pass left the surface, all along an edge
inclined_edges     arcs of the edges of a tool whose axis is inclined
inclined_arcs      where these meet the work, around the axis (compiled)
points_about_axis  tables of points of edges and of the work there
engagement_arcs    segments of all teeth with the arcs in which they cut
segment_ends       ends at which engagement changes (leaves for compiled code)
coupling           engagement and coupling of a point of a segment (leaves)
engaged_intervals  intervals of a group that are in the cut, and quadrature along them (leaves)
=================  =============================================================================
"""
