"""HyMeKo text: grammar, parser, printer, errors."""
