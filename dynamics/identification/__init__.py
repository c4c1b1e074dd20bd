"""Modal parameters from measured frequency response functions.

| module | responsibility | source |
|---|---|---|
| noise | noise of each line from the FRF alone | McKelvey and Guerin 2012 |
| band | lines that can be used | |
| polynomial | poles for every model order (pLSCF) | Peeters et al. 2004; Cauberghe et al. 2005 |
| stabilisation | diagram and poles that stay put | |
| residues | residues and residual terms of known poles | Heylen, Lammens and Sas 1998 |
| refinement | maximum-likelihood poles by variable projection | Golub and Pereyra 1973 |
| mode_quality, selection | number of modes | Schwarz 1978 |
| residual_terms | which residual terms the data support | Schwarz 1978 |
| tall | products and factors of tall matrices on one thread | Demmel et al. 2012 |
| prepare | sets with common poles, common lines | |
| real_modes, tool_point | real modes, mass and direction at the tool point | |
| fit, result, report | the call, its result, uncertainty and warnings | |
"""
