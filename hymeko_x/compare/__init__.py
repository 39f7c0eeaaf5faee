"""Differences between mechanisms, and the ledger of a conversion."""
