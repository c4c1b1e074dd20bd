"""The next measurement: the one that is expected to say most about what is left.

============ =======================================================================
module       responsibility
============ =======================================================================
alternatives models that a search leaves possible, and values that they may have
limits       ranges of the conditions that the user allows
information  what the outcome of a measurement is expected to say
proposal     the measurement of most information within the limits
============ =======================================================================
"""
