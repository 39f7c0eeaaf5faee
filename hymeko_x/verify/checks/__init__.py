"""The checks that make up a verdict: each module compares one side of two matched robots."""
