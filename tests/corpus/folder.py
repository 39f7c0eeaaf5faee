"""A folder of small robots of our own, in every format that is written by hand, for batch runs."""

from __future__ import annotations

from pathlib import Path

LINK = "<link name='{}'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
JOINT = (
    "<joint name='j{0}' type='revolute'><parent link='l{0}'/><child link='l{1}'/><axis xyz='0 0 1'/>"
    "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
)


def urdf(name: str, joints: int) -> str:
    links = "".join(LINK.format(f"l{i}") for i in range(joints + 1))
    return f"<robot name='{name}'>{links}{''.join(JOINT.format(i, i + 1) for i in range(joints))}</robot>"


MJCF = """<mujoco model="pendulum"><worldbody><body name="arm"><joint name="swing" axis="0 1 0"/>
<geom type="capsule" size=".1" fromto="0 0 0 0 0 1"/></body></worldbody></mujoco>"""

TOO_LARGE = """<mujoco><asset><texture name="t" type="2d" builtin="flat" width="60000" height="60000"/></asset>
<worldbody><body name="b"><joint name="j"/><geom size="1"/></body></worldbody></mujoco>"""
"""MuJoCo asks for 10.8 GB: what a process with a memory limit cannot have."""


def fill(folder: Path, robots: int = 5) -> Path:
    """Some URDFs, one MJCF, one HyMeKo robot, and one file that no reader takes."""
    folder.mkdir(parents=True, exist_ok=True)
    for count in range(1, robots + 1):
        (folder / f"arm{count}.urdf").write_text(urdf(f"arm{count}", count))
    (folder / "pendulum.xml").write_text(MJCF)
    (folder / "one.hymeko").write_text("one : robot { a { mass 1 inertia [1 1 1] } }\n")
    (folder / "broken.urdf").write_text("this is no robot")
    return folder
