"""One triangulation and one tree on many ranks: every function here is called by all ranks together."""
