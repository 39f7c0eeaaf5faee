"""hymeko-x against every other program that does the same, timed in turns. `python -m benchmarks.contest` runs it."""
