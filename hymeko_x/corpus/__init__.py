"""Robots of published packages: the catalogue, their cache, batch runs and statistics."""
