"""The suites of packages whose calls isoref takes over: `tests.peers.test_suites`."""
