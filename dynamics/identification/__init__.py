"""Modal parameters from measured frequency response functions.

| module | responsibility | source |
|---|---|---|
| band | lines that can be used | |
| polynomial | poles for every model order (pLSCF) | Peeters et al. 2004; Cauberghe et al. 2005 |
| stabilisation | diagram and poles that stay put | |
| residues | residues and residual terms of known poles | Heylen, Lammens and Sas 1998 |
| refinement | maximum-likelihood poles by variable projection | Golub and Pereyra 1973 |
| condensed | long FRFs on fewer lines that say the same | Golub and Welsch 1969 |
| mode_quality, selection | number of modes | Schwarz 1978 |
| delay | delay between the channels, before any residue | |
| discrepancy | what a model misses beyond the noise | Kennedy and O'Hagan 2001 |
| mode_indicators | MIF and MAC | Williams et al. 1985; Allemang and Brown 1982 |
| tall | products and factors of tall matrices on one thread | Demmel et al. 2012 |
| prepare | noise of each line, sets with common poles, common lines | McKelvey and Guerin 2012 |
| real_modes, tool_point | real modes, mass and direction at the tool point | |
| fit, result, report | the call, residual terms, result, uncertainty, warnings | Schwarz 1978 |
"""
