"""Sensor records of a flight as csv, one file a sensor."""
