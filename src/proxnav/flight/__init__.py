"""Simulated flights: truth under real forces, the readings of every sensor, and what goes wrong with them."""
