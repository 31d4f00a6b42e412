"""The vectorised twins: same names, same answers, made to be used.

`isoref.fast.sweep.sweep` gives what `isoref.sweep.sweep` gives, number for number, and so on for
each module here: the article explains, the twin works, and tests hold both to one mesh. What the
twins add are the tricks of the trade: slabs that fit a cache, look-ups by table, estimates of
memory. Nothing of what an algorithm *means* is decided here.
"""
