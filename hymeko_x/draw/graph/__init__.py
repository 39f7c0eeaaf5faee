"""Pictures of the hypergraph itself, as text: what is chosen, what stands beside it, where it stands, and the files of it."""
