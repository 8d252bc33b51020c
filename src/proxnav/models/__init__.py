"""Model folders: their card, and loading them without torch."""
