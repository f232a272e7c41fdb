"""Plans of many scenarios, one by one or by workers: what is finished is kept at once."""
