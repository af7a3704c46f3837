"""Delaunay with exact predicates and ties settled by coordinates alone: unique for every set of points."""
