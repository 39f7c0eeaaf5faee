"""The viewer in the browser: what it shows and how that moves (no library but numpy), and the page itself (viser)."""
