"""The version of the program: that of its tag, which the wheel and the first comment of every output have too."""

__version__ = "0.1.0"
