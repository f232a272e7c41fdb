"""Other libraries' optimisers beside ours, on one fitness: `make bench-peers`."""
