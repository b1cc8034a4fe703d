// UVs for a skin: a check of the given ones, and new ones where these are not usable. Charts, each flattened by least squares conformal
// maps (Levy, Petitjean, Ray and Maillot 2002).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "fluid/flow/flow_mesh.h"

namespace rivulet {

// Faults of a mesh's UVs, counted in triangles unless noted.
struct UvReport {
    size_t triangles = 0;
    bool missing = false;   // the mesh has no UVs
    size_t notNumbers = 0;  // or far beyond any map
    size_t noArea = 0;
    size_t tooWide = 0;            // wider than the map
    size_t mirrored = 0;           // not a fault
    size_t beyond = 0;             // with a corner outside 0 to 1: not a fault, they wrap round
    double overlap = 0;            // share of the covered texels that more than one triangle covers
    double lost = 0;               // share of the skin's area without texels of its own, for any reason but the last two
    double stretched = 0;          // share of the skin's area whose texels are more than 4 times as long as wide: not a fault
    double texel = 0, widest = 0;  // m, edge of a texel on the skin: the median over its area, and what 95 % of it does not exceed
    bool usable() const;           // little is lost and little overlaps
    std::string sentence() const;  // "" where nothing is wrong
};
// `uvs`: 3 a triangle, or none. `size`: texels of the map's edge on which it is tried.
UvReport checkUvs(const FlowMesh& mesh, std::span<const vec2> uvs, int size = 1024);

struct Unwrap {
    std::vector<vec2> uvs;        // 3 a triangle, within 0 to 1; a triangle without area has no area in UV
    std::vector<uint32_t> chart;  // of each triangle
    uint32_t charts = 0;
    double texelsPerMetre = 0;  // equal for all charts
    double distortion = 0;      // mean over the area of (a/b + b/a) / 2, a and b the singular values of the map; 1: conformal
};
// Charts do not overlap and are 2 `gutter` texels apart. Error (badInput): too many charts for a map of this size.
Result<Unwrap> unwrap(const FlowMesh& mesh, int size = 1024, int gutter = 3);

// The UVs of a mesh if they are usable, else new ones.
struct SkinUvs {
    std::vector<vec2> uvs;  // 3 a triangle
    UvReport given;
    bool unwrapped = false;
    uint32_t charts = 0;  // of the new ones
    std::string notice;   // a sentence for the log, or ""
};
Result<SkinUvs> skinUvs(const FlowMesh& mesh, const MeshView& from, int size = 1024);

}  // namespace rivulet
