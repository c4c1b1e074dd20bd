"""Pages of results.

============================= ======================================================
module                        responsibility
============================= ======================================================
console                       tables, lines and notes on the terminal, and for the report
recording                     the document that the running command fills
document                      what a report holds: answer, pictures, tables, inputs
methods                       what each command is asked and how it answers
html_page, pdf_page           a document as one page that stands alone, and as PDF
notebook                      a result as a notebook shows it
summary_rows                  table of what a summary.json holds
explanation                   report.html of `explain`; its text is in templates/
published_against_obtained    table of what a publication found beside a model
============================= ======================================================
"""
