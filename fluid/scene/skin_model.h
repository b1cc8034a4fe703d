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

// Which part is the skin, of several. named: the one that the parameters name. likely: if there is none, one that is called skin, face,
// head or body, else the largest.
enum class SkinPart { named, likely };

// Error (badInput): a file that is missing or damaged; SkinPart::named and no part of that name.
Result<SkinModel> loadSkinModel(const FlowParams& params, const std::string& sceneFolder, SkinPart which = SkinPart::named);

// The name by which `part` of a flow finds a part: its material's, if no other part has that, else its own.
std::string partName(const Model& model, size_t part);

// Where each mark comes from.
enum class MarkOf { none, file, found, proportions };

struct SkinMarks {
    FaceMarks marks;                        // in the flow's frame; `up` is +Y where neither the file says it nor a face was found
    std::string file;                       // of marks; "" = there is none
    std::array<MarkOf, 2> tears{}, lids{};  // of the left and right eye
    FoundFace found;                        // in the flow's frame; sought where the file leaves marks out
    // One sentence about marks that were found or could not be found; "" where the file has all.
    std::string notice;
};

// When a face is sought in the geometry.
enum class Seek { never, ifMarksAreMissing, always };

// Marks are read from the file that the flow names, or from the one beside the mesh: MESH.json or landmarks.json. What the file leaves out
// is found from the geometry. Error (badInput): the file that is named is missing; a file is damaged.
Result<SkinMarks> skinMarks(const FlowParams& params, const std::string& sceneFolder, const SkinModel& skin, Seek seek);

// True if a source of the flow needs marks.
bool needsMarks(const FlowParams& params);

// The rotation of a flow (deg, as its `rotation`) that turns a face, which was found or marked in its frame, upright and towards +Z.
vec3 uprightRotation(const FlowParams& params, const vec3& up, const vec3& forward);

}  // namespace rivulet
