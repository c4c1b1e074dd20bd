"""What a cut leaves behind.

======== ======================================================== ==========================
module   responsibility                                           source
======== ======================================================== ==========================
envelope wall and floor as the envelope of the arcs of the edges
texture  roughness, waviness, location error of a profile         ISO 4287, 4288, 16610-21
======== ======================================================== ==========================
"""
