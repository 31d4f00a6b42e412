"""Ways to an implementation: ``python:``, ``exec:``, ``dir:`` and the ready-made ones."""
