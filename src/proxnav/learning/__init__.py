"""Where rendering and detection meet to train: samples drawn on line, validation, calibration."""
