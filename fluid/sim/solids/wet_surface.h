// WetSurface: the points of the solids' surfaces that can be wet, in cells of a grid about each solid, in its own frame.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/core/math.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

class Buffer;

// A solid's share of the lists.
struct WetSolid {
    SolidRef solid;     // still: all static meshes, in the world's frame; rigid and body: each in its own
    vec3 corner{0.0F};  // m, the low corner of its grid
    float cell = 0;     // m, edge of a cell
    ivec3 size{0};      // cells
    uint32_t firstCell = 0, firstPoint = 0, points = 0;
    const VoxelField* field = nullptr;  // that it is made of; only to compare
    uint32_t body = 0;                  // id, of a body

    // Its own among those of the rigid solids and the bodies.
    Pose poseAmong(std::span<const Pose> rigid, std::span<const BodyState> bodies) const;
    mat4 cellsFromWorld(const mat4& toWorld) const;  // `toWorld`: own frame -> world
    mat4 cellsFromWorld(const Pose& pose) const;
};

// Made of the solids alone, so that a recording that holds one value a point can be drawn without a world.
struct WetSurface {
    struct Point {
        vec4 place;   // xyz m, in the solid's frame
        vec4 normal;  // xyz unit, outward; 0 where both sides are in one cell, or the mesh is not closed
    };
    std::vector<WetSolid> solids;
    std::vector<int32_t> cells;  // x fastest: the number of the cell's point, -1: the surface is not there
    std::vector<Point> points;

    // Cells of half a `spacing` (m), or larger where the voxels are, or the solid is so large that it would have more than a million.
    // Planes, deforming solids and bodies without a shell have none.
    static WetSurface of(const Solids& solids, float spacing) { return of(partsOf(solids), spacing, nullptr); }
    // A solid that may have some.
    struct Part {
        SolidRef solid;
        const VoxelField* field = nullptr;  // null: of a body
        const BodyShape* shape = nullptr;   // null: the water does not meet it
        uint32_t body = 0;                  // id
    };
    static std::vector<Part> partsOf(const Solids& solids);
    static void addBody(std::vector<Part>& parts, const Body& body, uint32_t id);
    // Solids of `before` are taken from there. Null: none.
    static WetSurface of(std::span<const Part> parts, float spacing, const WetSurface* before);
    // The values of its points, which those of `before` have now: of a static mesh that was baked again, where it was; else 0.
    std::vector<float> valuesFrom(const WetSurface& before, std::span<const float> wetness) const;
    // The one that is the same solid as `solid`. Null: there is none.
    const WetSolid* same(const WetSolid& solid) const;
    // The solid that is part of it; all static meshes are one. Null: it does not get wet.
    const WetSolid* find(const SolidRef& solid) const;
    // Of `wetness`, one value a point, at `place` (m, in the frame of solids[solid]): shaders/fluid/solids/wet_cells.h.
    float at(std::span<const float> wetness, size_t solid, const vec3& place) const;
};

// The wetness of a world on its Device.
struct WetnessView {
    std::shared_ptr<const WetSurface> surface;  // another object: another surface
    const Buffer* values = nullptr;             // float, for each of surface->points: 0 dry .. 1 wet. Another buffer after each frame
    const Buffer* cells = nullptr;              // int, surface->cells
};

}  // namespace rivulet
