"""The worked solution: from the declarations of a model to its equations, as a person writes it."""
