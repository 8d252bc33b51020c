"""Estimator and filter inside other people's loops: simulators, robots, streams that go on."""
