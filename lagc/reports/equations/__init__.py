"""The equations of motion as text, LaTeX, a page or a script."""
