"""Motion seen: the scene that a model implies, and pages, films and pictures of a run."""
