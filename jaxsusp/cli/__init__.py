"""The command line: parse, call the library, write. Results on stdout, progress on stderr.

One file per command or pair of commands. Exit status: 0 when it completed, 1 where the answer is
"infeasible", 2 for bad input, 130 when interrupted.
"""
