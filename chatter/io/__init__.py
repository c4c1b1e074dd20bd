"""Files in and out.

================ ==================================================================================
module           responsibility
================ ==================================================================================
formats          one module a format, their registry: FRFs, signals, matrices
files            opening within limits, text told from binary content
table            columns of numbers or words, whatever the format
headings         names and units of columns
stated_columns   tables of signals, headings stated where a file has none
trace_headings   names and units in headings of traces of controls
set_points       recorded set points of axes
signals          signals of a measurement in SI, by name
hammer_records   hammer records, one or a folder of them
matrices         matrices and nodes of a finite element program
recorded_columns columns of a run as CSV or Parquet
result_files     texts, summaries and pictures that results write
result_tables    tables of results as CSV or Parquet
presentation     pictures and pages of results, loaded when asked for
shipped_examples examples that are installed with the package
================ ==================================================================================
"""
