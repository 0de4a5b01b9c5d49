"""Studies of one model: many runs, and what they tell together."""
