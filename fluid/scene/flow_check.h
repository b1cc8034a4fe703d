// Says what a mesh needs to carry tears: unit, axes, parts, triangles, UVs, morph targets, marks.
#pragma once

#include <string>
#include <vector>

#include "fluid/flow/unwrap.h"
#include "fluid/scene/scene_file.h"
#include "fluid/scene/skin_model.h"

namespace rivulet {

struct FlowCheckRow {
    std::string label;     // "unit", "marks"
    std::string sentence;  // one or more
};

struct FlowCheck {
    std::vector<FlowCheckRow> rows;
    std::vector<std::string> needed;  // remedies, a sentence each; empty: the mesh is ready
    bool ready() const { return needed.empty(); }

    // The figures behind the sentences.
    float height = 0;       // m, of all parts, along the face's up
    float eyeDistance = 0;  // m; 0: not known
    float scale = 1;        // by which the mesh should be scaled further, so that it is in m
    mat3 turn{1.0F};        // by which it should be turned further, so that it is upright
    size_t triangles = 0, openEdges = 0;
    UvReport uvs;
    uint32_t charts = 0;  // of the new UVs; 0: the mesh's own are used
    int mapSize = 0;
    double texel = 0;  // m, edge of a texel on the skin: the root of the skin's area a texel, of the UVs that are used
    std::vector<std::string> morphs;
    SkinMarks marks;
    std::string part;  // that the liquid runs over

    // The flow as a scene should have it: all that the check knows is set.
    FlowParams wanted;
    std::string marksText;  // the marks as a JSON file beside the mesh: its unit and frame; a form to fill in where nothing is known
};

// Checks a mesh as a scene with these parameters would use it: mesh, part, marks, position, rotation, scale, fitSize and mapSize. If it has
// several parts and none is `part`, one is chosen, unless `partGiven`. Error (badInput): as loadSkinModel and skinMarks; no triangle
// with an area; a map that is too small for the charts.
Result<FlowCheck> checkFlow(const FlowParams& params, const std::string& sceneFolder, bool partGiven);

// A scene in which the mesh of a check cries, seen from before it. The check must have found a face (`marks.found.found()`).
SceneFile cryingScene(const FlowCheck& check);

}  // namespace rivulet
