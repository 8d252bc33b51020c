"""Images and labels on disk, and the records that travel between the rooms."""
