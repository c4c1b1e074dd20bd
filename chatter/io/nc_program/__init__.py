"""NC programs (ISO 6983): from text to blocks of lines and exact arcs, each with its feed.

======= ================================================================================
module  responsibility
======= ================================================================================
words   lines of a program as words, letter and number, without comments
codes   G and M codes that are known, and their groups
arcs    centre or radius of an arc -> its element
program the interpreter: modal state, and the blocks of a program
======= ================================================================================

What is not known is refused with file and line: a word that is passed over moves a machine
elsewhere than its control would.
"""
