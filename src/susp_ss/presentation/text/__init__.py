"""Results in words and tables, one module a kind of result."""
