"""Disciplines beside surfaces: contours (2-D), curves, simplices."""
