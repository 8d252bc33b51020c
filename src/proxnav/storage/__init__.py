"""Files that are whole or absent: atomic writes, locks, object storage, the cache, and what a run was asked."""
