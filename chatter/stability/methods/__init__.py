"""Stability methods, a package each; the registry lists the class of its `..._method`.

===================  ===========================================================================
package              method and source
===================  ===========================================================================
collocation          spectral elements (Khasawneh and Mann 2011)
matrix_free          propagated initial functions (Zatarain and Dombovari 2014)
semi_discretization  orders 0 to 2 (Insperger and Stepan 2004), full discretization (Ding 2010)
multi_frequency      harmonics of the coefficients (Budak and Altintas 1998)
zeroth_order         averaged coefficients (Altintas and Budak 1995)
time_domain          growth rate in simulated cuts
===================  ===========================================================================
"""
