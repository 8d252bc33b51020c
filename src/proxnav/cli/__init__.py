"""What the shell of every command shares: dispatch, help, progress."""
