"""Work on several processes or machines, through Dask distributed: who does it, and what is lost.

Everything else hands over jobs and takes back what they return, in whatever order they finish.
"""
