"""Which sensor contradicts which, and by what convention: hypothesis tests on raw readings."""
