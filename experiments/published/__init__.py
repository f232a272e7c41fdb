"""The tables and figures that the paper prints, from our own results."""
