"""Two robots compared on one page: verdict, checks, pictures, what was lost, trees; as HTML or as Markdown."""
