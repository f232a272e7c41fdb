"""Extensions of Sphinx that the pages need."""
