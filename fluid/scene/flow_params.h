// A scene's `flow`: skins, the liquid on them, its sources, and the motion of the face below. Metres, seconds, microlitres.
#pragma once

#include <string>
#include <vector>

#include "engine/core/params.h"
#include "engine/material/layer.h"
#include "engine/material/material.h"
#include "fluid/flow/surface_flow.h"

namespace rivulet {

inline constexpr double kMicrolitre = 1.0e6;  // picolitres

// A source of drops.
struct FlowSourceParams {
    std::string kind = "spot";     // corner | brim | spot | strewn | rain
    std::string side = "both";     // the eye: left | right | both
    float rate = 0;                // microlitres per minute, sum of all drops; 0 = off
    float drop = 1;                // microlitres per drop
    float start = 0, stop = 3600;  // s
    float swell = 0;               // 0 (steady) to 1 (fully modulated)
    float period = 4;              // s, of the swell
    // m, in the skin's own frame: a spot, or the centre of strewn drops or rain; of a corner or brim: where the tears of the nearer eye
    // start, 0 = at the eye.
    vec3 position{0.0F};
    float radius = 0.0F;            // m, about a spot; strewn or rain: about `position`; 0 = everywhere
    float speed = 9;                // m/s, of rain
    vec3 along{0.0F, -1.0F, 0.0F};  // direction of rain
    bool film = false;              // true: a continuous film instead of single drops
    void visit(ParamVisitor& v);
};

// One morph target's weight over time, kept within 0 to 1: weight + swing sin(2 pi (t / period + phase)). With a pulse, such as a blink or
// a sob, weight + swing for about `pulse` s once in each period, a little earlier or later each time; of what `hold` leaves of it, its rise
// takes 0.3.
struct ExpressionParams {
    std::string morph;
    float weight = 0, swing = 0, period = 3, phase = 0;
    float pulse = 0;  // s; 0: a sine wave
    float hold = 0;   // of a pulse: the share of it at full height
    double at(double time) const;
    void visit(ParamVisitor& v);
};

// Rigid motion of the skin about a pivot.
struct FlowMotionParams {
    vec3 pivot{0.0F};  // m, in the skin's frame
    vec3 turn{0.0F};   // deg, about x, then y, then z
    vec3 swing{0.0F};  // deg, amplitude of an oscillation
    float period = 3;  // s
    dmat4 at(double time) const;
    void visit(ParamVisitor& v);
};

// Factors on the force that holds a drop, by a painted mask: its red, green, blue and alpha channels in this order.
struct RegionParams {
    std::string mask;  // picture, over the mesh's UVs; "" = none
    float oily = 1.3F, dry = 0.9F, hair = 1.8F, lip = 0.7F;
    void visit(ParamVisitor& v);
};

struct FlowParams {
    std::string mode = "drops";  // drops | thesis
    std::string mesh = "meshes/head/head.glb";
    std::string part = "skin";  // of a file with several parts
    std::string instead;        // JSON file of another skin, used instead if its mesh is found; "" = none
    std::string hide;           // parts that are not drawn, by name or material, separated by ", "; a name may end in *
    std::string skinParts;      // parts with the skin material, as `hide`; the default head has its own list
    std::string marks;          // JSON with eyes, lids and the starts of tears; "" = the file next to the mesh, or found
    vec3 position{0.0F};        // m
    vec3 rotation{0.0F};        // deg
    float scale = 1;
    float fitSize = 0;   // m; > 0: the longest side is scaled to this length, and its centre is at `position`
    int mapSize = 1024;  // texels
    vec3 wind{0.0F};     // m/s
    SurfaceFlowParams liquid;
    ThesisParams thesis;
    FlowMotionParams motion;
    float amount = 1;      // factor of all rates of the sources
    float pace = 1;        // of the expression: seconds of it a second
    float expressive = 1;  // factor of all weights in expression
    bool marble = false;   // a statue: all parts of one marble, without hair
    float redness =
        0;  // 0..1: of the skin around eyes and nose and of the whites, at last; half of it at once, the rest with what is emitted
    std::vector<ExpressionParams> expression;
    std::vector<FlowSourceParams> sources;
    RegionParams regions;
    LayerLook look;
    Material material;  // of a mesh whose file has no material
    void visit(ParamVisitor& v);
};

// A named set of values: "path=value; path=value".
struct PresetParams {
    std::string name, doc, set;
    void visit(ParamVisitor& v);
};

}  // namespace rivulet
