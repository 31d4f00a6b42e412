"""What each command does, apart from its options: a module a group of commands.

`isograde.command` has the options, and imports a module of this package only when its command is
called: help and `check` shall not wait for libraries that they do not use.
"""
