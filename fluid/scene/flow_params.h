// A scene's `flow`: skins, what flows on them, where it comes from, and how the face under it moves. Metres, seconds, microlitres.
#pragma once

#include <string>
#include <vector>

#include "engine/core/params.h"
#include "engine/material/layer.h"
#include "engine/material/material.h"
#include "fluid/flow/surface_flow.h"

namespace rivulet {

// Where drops come from.
struct FlowSourceParams {
    std::string kind = "spot";      // corner | brim | spot | strewn | rain
    std::string side = "both";      // of an eye: left | right | both
    float rate = 0;                 // microlitres a minute, all together; 0 = off
    float drop = 1;                 // microlitres, of each
    float start = 0, stop = 3600;   // s
    float swell = 0;                // 0 steady .. 1: comes and goes
    float period = 4;               // s, of the swell
    vec3 position{0.0F};            // m, in the skin's own frame: of a spot, or above what it rains on
    float radius = 0.0F;            // m, about a spot; strewn or rain: about `position`; 0 = everywhere
    float speed = 9;                // m/s, of rain
    vec3 along{0.0F, -1.0F, 0.0F};  // the way rain falls
    bool film = false;              // a sheet, not single drops
    void visit(ParamVisitor& v);
};

// One morph target's weight over time: weight + swing sin(2 pi (t / period + phase)), kept within 0 to 1.
struct ExpressionParams {
    std::string morph;
    float weight = 0, swing = 0, period = 3, phase = 0;
    double at(double time) const;
    void visit(ParamVisitor& v);
};

// How the skin turns and moves as a whole, about a pivot.
struct FlowMotionParams {
    vec3 pivot{0.0F};  // m, in the skin's frame
    vec3 turn{0.0F};   // deg, about x, then y, then z
    vec3 swing{0.0F};  // deg, to and fro
    float period = 3;  // s
    dmat4 at(double time) const;
    void visit(ParamVisitor& v);
};

// What a painted mask says of a skin: how much of what holds a drop there is there. Channels red, green, blue, alpha of the picture.
struct RegionParams {
    std::string mask;  // picture, over the mesh's UVs; "" = none
    float oily = 1.3F, dry = 0.9F, hair = 1.8F, lip = 0.7F;
    void visit(ParamVisitor& v);
};

struct FlowParams {
    std::string mode = "drops";  // drops | thesis
    std::string mesh = "meshes/head/head.glb";
    std::string part = "skin";  // of a file with several
    std::string instead;        // JSON file of another skin, which takes its place where the mesh that it names is found; "" = none
    std::string hide;           // parts that are not drawn, by name or material, ", " between them; one may end in *
    std::string skinParts;      // parts that are made of skin, the same way; the default head knows its own
    std::string marks;          // JSON with eyes, lids and where tears begin; "" = beside the mesh, if there is one
    vec3 position{0.0F};        // m
    vec3 rotation{0.0F};        // deg
    float scale = 1;
    float fitSize = 0;   // m; > 0: the longest side's length, and its middle at `position`
    int mapSize = 1024;  // texels
    vec3 wind{0.0F};     // m/s
    SurfaceFlowParams liquid;
    ThesisParams thesis;
    FlowMotionParams motion;
    float expressive = 1;  // share of all of expression
    std::vector<ExpressionParams> expression;
    std::vector<FlowSourceParams> sources;
    RegionParams regions;
    LayerLook look;
    Material material;  // of a mesh whose file has none
    void visit(ParamVisitor& v);
};

// Values to set at one click, or by name: "path=value; path=value".
struct PresetParams {
    std::string name, doc, set;
    void visit(ParamVisitor& v);
};

}  // namespace rivulet
