"""What a conversion lost and changed, for people and programs: the lines on the terminal, JSON, SARIF."""
