"""What a target is made of: materials, texture coordinates, patterns, and how far looks vary."""
