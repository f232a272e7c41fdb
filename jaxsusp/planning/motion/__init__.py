"""How the load moves along its way: smooth paths, fast laws, calm laws."""
