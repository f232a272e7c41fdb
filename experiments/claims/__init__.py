"""What the paper claims, what its own tables say, and what our runs show."""
