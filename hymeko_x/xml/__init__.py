"""One tree of XML with positions, its printer, and the repair of damaged files."""
