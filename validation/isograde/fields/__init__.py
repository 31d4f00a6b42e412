"""Every case the grader knows, by id: one module a family, each with a function ``cases(seed)``."""
