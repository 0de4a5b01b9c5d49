"""Contact with dry friction: forces and impulses of contacts that touch."""
