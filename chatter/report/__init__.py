"""Pages of results.

============================= ======================================================
module                        responsibility
============================= ======================================================
explanation                   report.html of `explain`; its text is in templates/
published_against_obtained    table of what a publication found beside a model
============================= ======================================================
"""
