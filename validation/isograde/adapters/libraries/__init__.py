"""The libraries people use, and the reference: each in one module that stands on its own.

A module has plain functions that call the library as its users do, and two tables for
`isograde.adapters.registry`:

LIBRARY    the distribution that brings the library, and the modules to import before a call
METHODS    by ready-made name: the ``function``, the ``options`` that are bound to it, its
           ``declaration`` (`isograde.declaration`), measured and in nobody's favour, and what the
           function ``does`` for the library, to be told with the results

The functions import nothing of isograde, and their library only when they are called: their source,
printed as it stands, shows a failure without the grader (`registry.ReadyMade.source`).
"""
