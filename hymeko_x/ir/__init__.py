"""The structure that every format is read into: graph, parts, mechanism."""
