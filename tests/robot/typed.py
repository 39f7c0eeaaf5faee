"""Lines as users write them: mypy accepts those of RIGHT and refuses each of WRONG (test_typing.py)."""

HEAD = """
import hymeko_x as hx
from hymeko_x import deg, mm
arm, hand = hx.load("arm.urdf"), hx.load("hand.xml")
"""

RIGHT = """
upper: float | None = arm.joints["elbow"].limits.upper
mass: float = arm.mass
dofs: int = arm.dofs
parent: str = arm.joints["elbow"].parent.name
children: list[str] = [body.name for body in arm.bodies["base"].children]
place: hx.Pose = arm.fk({"elbow": 90 * deg})["fore"]
x: float = arm.fk()["fore"].xyz[0]
turned: hx.Pose = hx.Pose.from_rpy((0, 0, 90 * deg), (40 * mm, 0, 0))
moved: hx.Pose = turned @ turned
armed: hx.Robot = arm.attach(hand, at="flange", prefix="hand/")
hinged: hx.Robot = arm.attach(hand, at="flange", prefix="hand/", joint="hinge", pose=(0, 0, 0.1))
rest, part = armed.detach("hand/")
names: list[str] = [*part.bodies]
leg: hx.Robot = arm.subtree("upper")
parts: tuple[hx.Robot, ...] = armed.split()
merged: hx.Robot = arm.merge_fixed_joints(keep=["tool"])
bigger: hx.Robot = arm.scaled(2)
image: hx.Robot = arm.mirrored(names=("left", "right"))
variants: list[hx.Robot] = [arm.randomized(seed, mass=0.1) for seed in range(3)]
scene: hx.Robot = hx.compose((arm, hand), ((0, 0, 0), turned), names=("a", "b"), name="scene")
report: hx.Report = hx.dump(arm, "arm.xml", base="fixed")
text: str = hx.dumps(arm, "hymeko")
same: bool = hx.verify(arm, "arm.xml").is_same
verdict: str = hx.verify("arm.urdf", "arm.xml", joints=True, rename={"a_*": "*"}).verdict
count: int = len(hx.diff(arm, hand))
mechanism: hx.Mechanism = hx.load("arm.urdf").mechanism
lost: bool = bool(hx.convert("arm.urdf", "arm.usda", target="newton").losses)
role: str = arm.shapes["fore/visual"].body.name
drives: list[str] = [element.name for element in arm.actuators["motor"].drives]
colour = arm.materials["steel"].rgba
session = arm.edit()
"""

WRONG = """
arm.mass = 3.0
arm.joint
arm.joints.elbow
arm.joints[3]
arm.joints["elbow"].limits.uper
arm.joints["elbow"].parent.mas
arm.bodies["base"].children.name
arm.fk(90)
arm.fk()["fore"].position
arm.attach("hand.xml", at="flange")
arm.attach(hand, "flange", "hand/")
arm.attach(hand, at="flange", prefix=3)
arm.attach(hand, at="flange", pose=0.1)
arm.detach()
arm.detach("hand/").bodies
arm.subtree(arm.bodies["upper"])
arm.split("upper")
arm.merge_fixed_joints(["tool"])
arm.scaled("2")
arm.mirrored(names="left")
arm.randomized("seed")
arm.randomized(1, mass="0.1")
hx.compose(arm, hand)
hx.dump(arm)
hx.dumps(arm, 3)
hx.verify(arm)
hx.verify(arm, hand, sample=5)
hx.convert("arm.urdf")
hx.load("arm.urdf").bodies["base"].shapes["visual"]
hx.Pose.from_rpy(1, 2, 3)
turned = hx.Pose.from_rpy((0, 0, 1)) * 2
hx.load("arm.urdf").graph
arm.joints["elbow"].limit = (-1, 1)
session.bodies["fore"].colour = (1, 0, 0)
"""
