"""The machine file.

=========== ========================================================================
module      responsibility
=========== ========================================================================
machine_file MachineFile: what a machine file says; positions and conditions
bodies      [body], [connector], [point], [contact]
beam        [beam]
imported    [imported]
axis        [axis]: what travels, brake
drive       [axis.NAME.drive]
control     [axis.NAME.control]
friction    [friction]
frf_section [frf]: virtual tests and their states
move_section [move]: trajectories
fields      field types; kinds and their keys
references  checks across sections
compose     sections at positions of the axes -> parts of a machine
telling     errors of the mechanics, by file and key
schema      JSON schema
=========== ========================================================================

Reading, patching and writing back are those of a case: `chatter.description.patchable`.
"""
