"""The tools for language models: a server of the Model Context Protocol, confined to one folder."""
