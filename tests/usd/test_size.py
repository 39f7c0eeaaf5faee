"""Large stages: the time per prim does not grow with their number, and nothing of them is lost."""

from __future__ import annotations

import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from hymeko_x import formats, pipeline
from hymeko_x.corpus.plan import peak_megabytes
from hymeko_x.diagnostics import Report
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.usd.stages import HEADER

PER_BODY = 4
MOST_MEMORY = 3200.0
"""MB; what is measured is about 960."""


def chain(prims: int) -> str:
    """A chain of bodies, each with a collider, a prim of an unknown type, and a joint to the body before."""
    bodies = prims // PER_BODY
    parts = [HEADER, 'def Xform "robot" (\n    prepend apiSchemas = ["PhysicsArticulationRootAPI"]\n)\n{\n']
    for number in range(bodies):
        parts.append(
            f'def Xform "b{number}" (\n    prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]\n)\n{{\n'
            f"    float physics:mass = 1\n    double3 xformOp:translate = (0, 0, {number})\n"
            '    uniform token[] xformOpOrder = ["xformOp:translate"]\n'
            '    def Cube "box" (\n        prepend apiSchemas = ["PhysicsCollisionAPI"]\n    )\n    {\n        double size = 0.1\n    }\n'
            f'    def Xform "tip"\n    {{\n        custom int note = {number}\n    }}\n}}\n'
        )
    for number in range(1, bodies):
        parts.append(
            f'def PhysicsRevoluteJoint "j{number}"\n{{\n    rel physics:body0 = </robot/b{number - 1}>\n'
            f"    rel physics:body1 = </robot/b{number}>\n    point3f physics:localPos0 = (0, 0, 1)\n"
            '    uniform token physics:axis = "X"\n}\n'
        )
    return "".join([*parts, "}\n"])


def back_and_forth(prims: int) -> tuple[Mechanism, bytes, float]:
    """The mechanism of a chain, the stage that is written of it, and the processor time for both in s."""
    text = chain(prims).encode()
    start = time.process_time()
    mechanism = pipeline.read(Source("chain.usda", text, NoFiles()), formats.USD, Report())
    package = pipeline.write(mechanism, formats.USD, Options(), NoFiles(), Report())
    return mechanism, package.main, time.process_time() - start


def assert_whole(mechanism: Mechanism, data: bytes, prims: int) -> None:
    bodies = prims // PER_BODY
    assert (len(mechanism.joints), len(mechanism.shapes)) == (bodies, bodies)  # the first body falls, by a joint without a prim
    assert data.count(b"def Cube ") == bodies
    assert data.count(b"custom int note = ") == bodies
    assert data.count(b"def PhysicsRevoluteJoint ") == bodies - 1


def test_a_chain_is_written_with_all_of_its_prims() -> None:
    mechanism, data, _ = back_and_forth(400)
    assert_whole(mechanism, data, 400)


def cost_of_many() -> tuple[float, float]:
    """How many times as long ten times as many prims take, and the most memory of this process in MB."""
    _, _, short = back_and_forth(10_000)
    mechanism, data, long = back_and_forth(100_000)
    assert_whole(mechanism, data, 100_000)
    return long / short, peak_megabytes()


@pytest.mark.full
def test_a_stage_of_a_hundred_thousand_prims_takes_its_time_and_no_more() -> None:
    """In a process of its own: the memory is that of no other test."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        ratio, memory = pool.submit(cost_of_many).result()
    assert ratio < 2.0 * 10
    assert memory < MOST_MEMORY
