"""Two trees of the package in alternating runs of a few short canaries; a history by release."""
