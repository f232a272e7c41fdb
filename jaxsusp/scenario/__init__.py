"""What a person states: a scenario from its TOML file, checked without any search, and its arrays.

`models` says what a file holds, `admissible` what must hold between its values, `scenario` joins
both, `world` turns a scenario into the arrays that JAX sees, and `data` has the built-in ones.
"""
