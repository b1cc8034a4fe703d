// The model file of a flow: loaded and placed as its parameters say, its skin, and the marks of its face.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/model.h"
#include "fluid/scene/face_marks.h"
#include "fluid/scene/find_face.h"
#include "fluid/scene/flow_params.h"

namespace rivulet {

struct SkinModel {
    std::string path;
    Model model;      // its parts are in the flow's frame (m, about `position`), not in their nodes'
    mat4 to{1.0F};    // the file's frame -> the flow's
    size_t skin = 0;  // the part that the liquid runs over
};

// Error (badInput): a file that is missing or damaged, no part of the name.
Result<SkinModel> loadSkinModel(const FlowParams& params, const std::string& sceneFolder);

// Where each mark comes from.
enum class MarkOf { none, file, found, proportions };

struct SkinMarks {
    FaceMarks marks;                        // in the flow's frame
    std::string file;                       // of marks; "" = there is none
    std::array<MarkOf, 2> tears{}, lids{};  // of the left and right eye
    FoundFace found;                        // in the flow's frame; sought where the file leaves marks out
    // One sentence about marks that were found or could not be found; "" where the file has all.
    std::string notice;
};

// Marks are read from the file that the flow names, or from the one beside the mesh: MESH.json or landmarks.json. What the file leaves out
// is found from the geometry. `seek`: false: it is not sought. Error (badInput): the file that is named is missing; a file is damaged.
Result<SkinMarks> skinMarks(const FlowParams& params, const std::string& sceneFolder, const SkinModel& skin, bool seek);

// True if a source of the flow needs marks.
bool needsMarks(const FlowParams& params);

// The rotation of a flow (deg, as its `rotation`) that turns a face, which was found or marked in its frame, upright and towards +Z.
vec3 uprightRotation(const FlowParams& params, const vec3& up, const vec3& forward);

}  // namespace rivulet
