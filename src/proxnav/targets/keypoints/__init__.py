"""The points of a target that are looked for: chosen, judged, read from files, seen or hidden."""
