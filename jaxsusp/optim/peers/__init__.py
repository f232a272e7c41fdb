"""Algorithms of other libraries by names such as "evosax:CMA_ES", an adapter for each."""
