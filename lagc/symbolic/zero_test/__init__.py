"""Whether an expression is zero everywhere: the test of Schwartz and Zippel."""
