"""Case file and machine file: keys, units, patches, errors, schema.

=================== ================================================================
module              responsibility
=================== ================================================================
case                Case: what a case file says
sections            the sections of a case file
machine             the machine file and its sections
patchable           reading, patching, writing back; shared by both files
law_section         registries of force and friction laws; sections made from them
registry            entries by name, ours and those of installed packages
renamed             keys with a new name; the old one is read for one release
units               quantities with units; the one units registry
quantities          field types: dimension and range of each key, declared once
path, assignments   dotted paths; ``--set PATH=VALUE`` of the command line
toml_document       the TOML document behind a file; toml_editing keeps its comments
case_checks         checks across sections; plausibility: numbers that must be wrong
wording, formatting sentences for what is wrong, keys of another kind; values in messages
errors, progress    InputError and RunError; how far a computation is
json_schema         JSON schemas of the case file and the machine file
=================== ================================================================
"""
