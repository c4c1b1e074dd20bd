"""The case file.

=========== ========================================================================
module      responsibility
=========== ========================================================================
case        Case: what a case file says
description reading, patching, writing back; shared with the machine file
tool        [tool]
material    [material]
cut         [cut]
structure   [structure]
sections    the smaller sections
checks      checks across sections
quantities  field types: dimension and range of each key, declared once
path        dotted paths into a case
assignments ``--set PATH=VALUE`` of the command line
document    the TOML document behind a case: text, values, file names
editing     changes of the document that keep its comments
wording     sentences for what is wrong
schema      JSON schema
=========== ========================================================================
"""
