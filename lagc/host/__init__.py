"""The machine that lagc runs on: files, cache, budgets of time and memory, orphan processes."""
