"""Images as arrays: crops, sizes, codecs, tones."""
