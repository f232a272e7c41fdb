"""Sect. 3.2: population optimisers, one contract, one driver."""
