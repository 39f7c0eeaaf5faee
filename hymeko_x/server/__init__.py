"""The language server: what an editor asks about robot descriptions while they are written."""
