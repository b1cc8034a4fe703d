#!/bin/bash
# The ICT face: says where it comes from and what it must look like, and fetches the neutral mesh's source.
#   bash assets/fetch_ict_head.sh [FOLDER]      FOLDER: where assets are to lie, later named by RIVULET_ASSETS
set -eu
folder=${1:-${XDG_DATA_HOME:-$HOME/.local/share}/rivulet/assets}
commit=da5f95a607f5e6b37755b38d3385d7f2853732e5
source=https://github.com/ICT-VGL/ICT-FaceKit
cat <<TEXT
The ICT face model (Li et al., "Learning Formation of Physically-Based Face Attributes", CVPR 2020; USC Institute for Creative
Technologies, MIT licence) is not part of this repository: $source

The crying scene takes it where it finds, in a folder of RIVULET_ASSETS:
  ict_head/ict_head_full.glb   metres, +Y up, face along +Z; materials M_Face, M_BackHead, M_Sclera*, M_Iris*, M_EyeBlend, ...;
                               the model's expressions as morph targets (browInnerUp_L, mouthFrown_R, ...)
  ict_head/landmarks.json      "tear_points": {"left_inner_corner": {"pos_cm": [x, y, z]}, left_lower_lid_inner_third,
                               left_lower_lid_outer_third, left_outer_corner, and the same of right}
The repository has the neutral mesh and one OBJ per expression (FaceXModel/); Blender joins them as shape keys and writes the glb.
TEXT
target="$folder/ict_head/source"
if [ -d "$target/.git" ]; then
    echo "It has been fetched already: $target"
    exit 0
fi
command -v git > /dev/null || { echo "git is not installed: install it, or download $source by hand" >&2; exit 1; }
mkdir -p "$folder/ict_head"
if ! git clone --quiet "$source" "$target.partial" || ! git -C "$target.partial" checkout --quiet "$commit"; then
    rm -rf "$target.partial"
    echo "$source could not be fetched: see whether the network is there, then run this again" >&2
    exit 1
fi
mv "$target.partial" "$target"
echo "Fetched to $target. Put ict_head_full.glb and landmarks.json beside it, then: RIVULET_ASSETS=$folder rivulet run crying"
