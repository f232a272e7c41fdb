"""What can be told of a task before any plan."""
