"""Random and damaged input of every kind: each has to end in an answer or in one clear refusal.

    python -m benchmarks.fuzzing OUT --count 100000

Case, machine and measurement files are drawn by Hypothesis from their JSON schemas, whole or as
changes of shipped files; measured files of every format are written, then damaged. Each input is
answered in a process of its own, by a call of Python or by a command.

============== ===================================================================================
module         responsibility
============== ===================================================================================
from_schema    strategies of values and documents from a JSON schema
from_shipped   strategies of shipped documents with changed, added and missing keys
damaged_bytes  strategies of damaged content of files
odd_records    strategies of whole records that no cut makes
sample_files   a real file of every format
answers        what is asked of each kind of input
isolated       one input in a process of its own, within limits of time and memory
campaign       batches of inputs with a journal: an ended run goes on
============== ===================================================================================
"""
