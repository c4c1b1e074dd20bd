"""The machine: structure, modes, frequency responses; knows nothing of cutting.

============== =====================================================================
module         responsibility
============== =====================================================================
frf            container of frequency response functions, conversion of quantities
formats        UFF-58, CSV and CutPro files into the container
hammer         hammer time records: reading, examination, H1/H2 with coherence
modal          real modes at the tool point and their receptance
modal_steps    exact discrete step of a modal model, energy
identification modal parameters from measured FRFs
============== =====================================================================
"""
