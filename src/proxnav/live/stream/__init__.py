"""Images that come one after the other (a folder that fills, a video, a camera) answered as they come."""
