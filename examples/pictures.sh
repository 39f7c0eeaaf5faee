#!/bin/sh
# Makes the pictures of the README and of the pages anew: `sh examples/pictures.sh` in a checkout, with hymeko-x on the path.
set -eu
cd "$(dirname "$0")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

arm="$folder/arm"
cp corpus/robots/arm6.hymeko "$arm.hymeko"
for suffix in urdf xml xacro usda sdf; do hymeko-x convert -q "$arm.hymeko" "$arm.$suffix"; done
hymeko-x render "$arm.hymeko" "$arm.urdf" "$arm.xml" "$arm.xacro" "$arm.usda" "$arm.sdf" --size 320x300 -o docs/pictures/arm.png
hymeko-x dynamics corpus/listings/quarter_vehicle_model.hymeko --bode docs/pictures/bode.svg -o "$folder/quarter.txt"

python examples/listings.py docs/robot.md "$folder"
echo '{"left/shoulder": 0.4, "left/elbow": 0.8, "right/shoulder": 0.4, "right/elbow": 0.8}' > "$folder/pose.json"
hymeko-x render "$folder/station.xml" --pose "$folder/pose.json" --size 640x420 -o docs/pictures/station.png
