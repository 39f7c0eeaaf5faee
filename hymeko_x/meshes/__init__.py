"""Geometry and images of files: reading, measuring, converting."""
