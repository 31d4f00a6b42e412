"""Whatever reads from outside, given inputs that nobody would write (`tests.fuzz.run`)."""
