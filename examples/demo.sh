#!/bin/sh
# The main job on a real robot: the Unitree G1 humanoid as its makers' URDF, 53 links and 43 joints with 49 meshes.
# It becomes HyMeKo text, goes back to URDF without a difference, and becomes MJCF that MuJoCo simulates and that is verified.
set -eu

if [ -t 1 ]; then bold=$(printf '\033[1m') plain=$(printf '\033[0m'); else bold='' plain=''; fi
say() { printf '\n%s%s%s\n' "$bold" "$*" "$plain"; }
run() { printf '$ %s\n' "$*"; "$@"; }
letters() { tr -d ' \n\t' < "$1" | wc -c | tr -d ' '; }

mkdir -p demo
cd demo

say "1. Fetch a real robot (131 MB, once)"
printf '$ hymeko-x corpus fetch example_robot_data\n'
corpus=$(hymeko-x corpus fetch example_robot_data)
robots="$corpus/cmeel.prefix/share/example-robot-data/robots"
ln -sf "$robots/g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf" g1.urdf
package="example-robot-data=$corpus/cmeel.prefix/share/example-robot-data"
run hymeko-x info g1.urdf

say "2. URDF -> HyMeKo, the readable form of the hypergraph"
run hymeko-x import g1.urdf -o g1.hymeko
grep -v '^ *urdf ' g1.hymeko | sed -n '1,4p;/left_hip_pitch_link {/,/left_hip_roll_joint/p' | cut -c1-140
printf '...  %s characters; the URDF has %s (white space not counted)\n' "$(letters g1.hymeko)" "$(letters g1.urdf)"

say "3. HyMeKo -> URDF: the same robot, element by element"
run hymeko-x export g1.hymeko -o back.urdf
run hymeko-x diff g1.urdf back.urdf && echo "no difference"

say "4. URDF -> MJCF with its meshes"
run hymeko-x convert g1.urdf g1.xml --for mujoco --base free --actuators position --package "$package"
echo "demo/g1.xml and $(ls meshes | wc -l | tr -d ' ') meshes beside it"

say "5. MuJoCo reads the result and simulates one second"
python - <<'PYTHON'
import mujoco

model = mujoco.MjModel.from_xml_path("g1.xml")
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
while data.time < 1.0:
    mujoco.mj_step(model, data)
print(f"{model.nbody - 1} bodies, {model.nv} degrees of freedom, {model.nu} actuators, {model.nmesh} meshes, {model.body_mass.sum():.3f} kg")
print(f"after {data.time:.2f} s of free fall the pelvis is {-data.qpos[2]:.2f} m lower, and the fastest joint moves at {abs(data.qvel[6:]).max():.2f} rad/s")
PYTHON

say "6. The engines of both formats compare what was simulated with the URDF: kinematics, masses, limits, shapes"
run hymeko-x verify g1.urdf g1.xml --package "$package"
