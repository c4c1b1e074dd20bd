"""Cutting tests judged stable or chatter: what they say beside their verdicts, and the search.

=================== ================================================================
module              responsibility
=================== ================================================================
spindle_power       mean power of a cut; readings in another unit, readings out of line
wear                effect of a tool that wears from test to test, in its forms
priors              declared values with tolerances that a clear contradiction widens
fit_to_tests        least of likelihood and priors over predictions that are nearly linear
starts              where fits begin: values drawn from their tolerances
evidence            how much better one model of the tests is than another
search_of_tests     which effects the tests ask for
reliability         whether holdout tests are predicted as well as the scatter allows
refitted            declared values that were refitted, and by how much
report_on_tests     verdict, and what explanation.json says of tests
limits              limits of the tool at the first and at the last test
=================== ================================================================
"""
