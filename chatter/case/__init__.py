"""The case file.

========== ========================================================================
module     responsibility
========== ========================================================================
case       Case: reading, patching, writing back
tool       [tool]
material   [material]
cut        [cut]
structure  [structure]
sections   the smaller sections
quantities field types: dimension and range of each key, declared once
path       dotted paths into a case
document   the TOML document behind a case
wording    sentences for what is wrong
schema     JSON schema
========== ========================================================================
"""

from chatter.case.case import Case, load, loads, parse_assignments
from chatter.case.schema import schema

__all__ = ["Case", "load", "loads", "parse_assignments", "schema"]
