"""Oracles. None shares code, numbering or arithmetic with what it judges."""
