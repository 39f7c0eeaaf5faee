"""Small mechanisms for tests, and files that live in memory."""

from __future__ import annotations

from msgspec import Struct, field

from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism, RobotEdge, joint_edge
from hymeko_x.ir.parts import Body, Dof, DofKind, Inertial, Joint, VertexPart, World
from hymeko_x.ir.values import IDENTITY, Pose

SOLID = Inertial(1.0, (0.0, 0.0, 0.1), (0.1, 0.1, 0.1, 0.0, 0.0, 0.0))


class MemoryFiles(Struct):
    """Files by path; a uri is its own path. A :class:`hymeko_x.source.Files`."""

    content: dict[str, bytes] = field(default_factory=dict)

    def find(self, uri: str) -> str | None:
        return uri if uri in self.content else None

    def read(self, path: str) -> bytes:
        if path not in self.content:
            raise FileNotFoundError(path)
        return self.content[path]


def body(name: str) -> Id:
    return Id("body", name)


def joint(name: str) -> Id:
    return Id("joint", name)


def chain(
    *joints: Joint,
    inertial: Inertial | None = SOLID,
    child_pose: Pose = IDENTITY,
    edges: dict[Id, RobotEdge] | None = None,
    vertices: dict[Id, VertexPart] | None = None,
) -> Mechanism:
    """Bodies ``b0``, ``b1``, ... with joints ``j1``, ``j2``, ... between them, each 1 m above the last; ``b0`` is the open base."""
    bodies: dict[Id, VertexPart] = {WORLD: World()}
    bodies |= {body(f"b{number}"): Body(inertial) for number in range(len(joints) + 1)}
    links = {
        joint(f"j{number}"): joint_edge(data, body(f"b{number - 1}"), body(f"b{number}"), Pose((0.0, 0.0, 1.0)), child_pose)
        for number, data in enumerate(joints, 1)
    }
    return Mechanism("chain", Hypergraph({**bodies, **(vertices or {})}, {**links, **(edges or {})}))


def hinge(**fields: object) -> Joint:
    return Joint((Dof(DofKind.HINGE, **fields),))  # type: ignore[arg-type]
