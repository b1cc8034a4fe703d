// FluidLook: the appearance of a fluid, for every renderer.
#pragma once

#include "engine/core/math.h"
#include "engine/core/table.h"

namespace rivulet {

struct FilterRow;  // fluid/render/filters.h

// What the colour of a point shows.
enum class ColourBy { speed, density, id, dye, normal, surface, sleep };
struct ColourRow {
    const char* name;
    const char* doc;
    ColourBy colourBy;
    bool normals = false;  // shows the surface's normals, which the world then computes
};
const Table<ColourRow>& colourings();

// The water, or an intermediate result of it.
enum class WaterView { water, normals, depth, spheres, thickness };
struct ViewRow {
    const char* name;
    const char* doc;
    WaterView view;
};
const Table<ViewRow>& waterViews();

struct FluidLook {
    ColourBy colourBy = ColourBy::speed;  // points
    float fullSpeed = 3.0F;               // m/s: the end of the colour map
    const FilterRow* filter = nullptr;    // of the surface's depth: a row of filters(); null: the first
    float smoothing = 0.0F;               // m, reach of the smoothing, two standard deviations; 0 = 1.8 spacings
    float smoothingRange = 0.0F;          // m, largest difference of depths on one surface; 0 = 4.2 spacings
    // Of pure water, as the row `water` of liquids() (fluid/sim/sources/liquids.h).
    vec3 absorption{0.2755F, 0.0565F, 0.00922F};    // 1/m, Beer-Lambert per channel: of 620, 550 and 450 nm
    vec3 scattering{0.00085F, 0.00146F, 0.00346F};  // 1/m, reduced, per channel
    float refractiveIndex = 1.333F;                 // > 1
    float detail = 0.0F;                            // pixels: below this radius only some particles are drawn, each larger; 0: all
    bool caustics = true;                           // the water refracts light onto what lies behind it
    WaterView view = WaterView::water;              // screen_space
    bool fast = false;                              // the surface at half the resolution, no reflection of the picture in itself
};

}  // namespace rivulet
