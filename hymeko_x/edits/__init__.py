"""Edits brought home: what was edited in a file that was converted from another one becomes an edit of that one's own text.

ORIGINAL is converted again, and the result is compared with EDITED; what differs are the edits. They are applied to the mechanism of
ORIGINAL, and this is printed before and after in its own format. The two prints differ in what is edited, and in nothing else. Their
difference is carried over to the text of ORIGINAL, block by block (:mod:`hymeko_x.outline`): values in place, blocks inserted, removed
and moved. What was written is read again and has to be the edited mechanism; where it is not, the blocks in question are replaced by
their print.
"""
