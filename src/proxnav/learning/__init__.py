"""Where rendering and detection meet to train: samples drawn on line, set-ups, validation, calibration, export."""
