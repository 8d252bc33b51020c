"""One file per command of the command line: options, one call, a print."""
