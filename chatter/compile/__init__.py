"""From a case to flat arrays: tool, forces, structure, machine.

=================== =================================================================
module              responsibility
=================== =================================================================
cutter              tool, force laws and flank of a case
structure           modes of a case, as given, measured or of a linearised machine
measured_frf        structure of measured FRFs; signs and passivity of drive points
real_modes          real modes fitted to a receptance
chip_of_teeth       thickest chip where teeth do not share the feed evenly
teeth_on_the_tool   setting errors that would move a tooth off its tool
machine_parts       machine file to an assembled machine
machine_cut         machine of a case: who feeds, what turns, where the cut acts
linearised_friction motion free of strain, frictions linearised about it, FRFs with them
linearised_machine  receptance and modes of a machine at the tool point
=================== =================================================================
"""
