"""Training, whatever the network: exact resume, averaged weights, learning curve, early stop."""
