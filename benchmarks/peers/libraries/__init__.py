"""One module per library, each with its `PEERS`. Importing one needs its library."""
