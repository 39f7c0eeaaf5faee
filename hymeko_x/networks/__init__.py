"""Lumped networks of a mechanism, read and checked: masses, grounds, branches of springs, dampers and ports, and their domains."""
