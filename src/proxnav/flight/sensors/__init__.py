"""What each sensor reads of the truth."""
