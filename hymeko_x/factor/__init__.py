"""Factoring: forms that repeat up to parameters are written once, as macros.

Works on any tree of tags and texts, so that one pass serves every backend. A backend

1. hands in its own text as forms (:class:`~hymeko_x.factor.forms.FormElement`: tag, leaves, children) and a
   :class:`~hymeko_x.factor.forms.Dialect`:
   the costs of definitions, calls and holes in its text, in characters;
2. gets back :class:`~hymeko_x.factor.forms.Factored`: macros with parameters and defaults, named values, and the items with calls
   among them. ``expand(factor(forms, dialect)) == forms``, to the last digit of every number;
3. prints holes, calls and macros in its own spelling::

    forms = (
        Element("link", (("name", "l_hip"), ("mass", "1.5"), ("at", "0 0.1 0"), ("com", "0 0.02 0"))),
        Element("link", (("name", "r_hip"), ("mass", "1.5"), ("at", "0 -0.1 0"), ("com", "0 -0.02 0"))),
        ...
    )
    found = factor(forms, Dialect(call=9, hole=3, ...))
    # macros: hip(prefix, side=1) = link name=(Hole("prefix"), "_hip") mass="1.5" at=("0 ", Signed(("side",), False, "0.1"), " 0") ...
    # items:  Call("hip", (("prefix", "l"),)), Call("hip", (("prefix", "r"), ("side", "-1")))

A text is cut into numbers, words and separators; a hole takes whole pieces. Where numbers differ by their sign alone, and
the same signs change in several places, the sign becomes a parameter ("1" or "-1"; :class:`~hymeko_x.factor.forms.Signed`).
"""
