"""Our own data set on disk: images, masks, labels, camera and scenes."""
