"""Whether the files of a repository that are one robot in several formats agree: what `hymeko.toml` lists, compared by the verifier."""
