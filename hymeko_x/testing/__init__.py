"""For tests of this program and of others that use it: Hypothesis strategies of robots and of texts, and damage to texts.

    from hypothesis import given
    from hymeko_x.testing import Knobs, mechanisms

    @given(mechanisms(Knobs(loops=False)))
    def test_my_planner_takes_any_tree(robot): ...

Needs Hypothesis: ``pip install hymeko-x[testing]``.
"""

from hymeko_x.testing.arms import arms
from hymeko_x.testing.documents import DOCUMENTS
from hymeko_x.testing.mechanisms import EVERYTHING, TREES, Knobs, mechanisms
from hymeko_x.testing.mutations import mutated
from hymeko_x.testing.urdf import urdf_mechanisms

__all__ = ["DOCUMENTS", "EVERYTHING", "TREES", "Knobs", "arms", "mechanisms", "mutated", "urdf_mechanisms"]
