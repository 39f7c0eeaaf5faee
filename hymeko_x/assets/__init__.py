"""Files that robots refer to: found, and placed beside an output."""
