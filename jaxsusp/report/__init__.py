"""Tables and figures: take a dataset, return tables or Axes; compute no physics."""
