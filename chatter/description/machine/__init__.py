"""The machine file.

================== ========================================================================
module             responsibility
================== ========================================================================
machine_file       MachineFile: what a machine file says; positions and conditions
bodies             [body], [connector], [point], [contact], [imported]
beam               [beam]
axis               [axis]: what travels, brake
drive              [axis.NAME.drive]
control            [axis.NAME.control]
friction           [friction]
frequency_response [frf]: virtual tests and their states
move               [move]: trajectories
fields             field types; kinds and their keys
references         checks across sections
compose            sections at positions of the axes -> parts of a machine
errors_by_key      errors of the mechanics, by file and key
================== ========================================================================

Reading, patching and writing back are those of a case: `chatter.description.patchable`.
"""
