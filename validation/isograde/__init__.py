"""A grader for isosurface extractors: fields, doors, truths, claims and reports."""
