"""A grader for isosurface extractors: cases, adapters, oracles, claims and reports."""
