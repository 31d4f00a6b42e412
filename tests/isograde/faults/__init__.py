"""Extractors that are broken on purpose, and who catches them.

registry    what a fault is, and the decorator that registers one
engine      marching cubes in steps, sound, of which a fault exchanges one
blind       faults whose author knew the README and `isograde explain` alone
histories   faults of the kinds in public trackers and histories
kinds       faults of other families and other (n, m)
outsiders   shortcuts that nobody looked for, and what the plan lets pass
placed      faults of axes that run elsewhere in the world
strangers_numbers, strangers_shapes
            written by two who knew the README and `isograde explain` alone, for plan 4
strangers_third
            written by a third, who met plan 4: what survived it stands in `registry.SURVIVORS`
catching    the default plan, asked until a promise is broken
matrix      ``make faults``: the whole plan, every fault, every claim, into a report
caught.json for each fault a case of the plan that catches it, and what is broken there;
            "after" names the case before it, by hand, for who keeps something from call to call
"""
