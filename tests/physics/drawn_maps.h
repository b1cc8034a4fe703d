// A flow on a skin and its maps, for tests of what the maps show.
#pragma once

#include <gtest/gtest.h>

#include <glm/packing.hpp>

#include <algorithm>
#include <memory>
#include <vector>

#include "fluid/flow/flow_maps.h"
#include "fluid/flow/map_texels.h"
#include "fluid/flow/skin_folds.h"
#include "fluid/flow/surface_flow.h"
#include "fluid/flow/unwrap.h"
#include "shaders/flow/map_step.h"
#include "tests/physics/charted_skins.h"
#include "tests/physics/worlds.h"

namespace rivulet::test {

constexpr uint32_t kMicrolitre = 1000000;  // picolitres

// A flow on a skin and its maps, and what the maps' texels show.
struct Drawn {
    std::unique_ptr<Device> device;
    std::unique_ptr<SurfaceFlow> flow;
    std::unique_ptr<FlowMaps> maps;
    MapTexels layout;
    std::vector<vec2> uvs;

    // `checked`: the skin's UVs are replaced if they are not usable.
    Drawn(const Skin& skin, int size, const SurfaceFlowParams& params = {}, bool checked = false) : device(cpu()) {
        Result<FlowMesh> mesh = makeFlowMesh(skin.view());
        EXPECT_TRUE(mesh);
        uvs = cornerUvs(*mesh, skin.view());
        if (checked) {
            Result<SkinUvs> usable = skinUvs(*mesh, skin.view(), size);
            EXPECT_TRUE(usable);
            uvs = std::move(usable->uvs);
        }
        layout = layTexels(*mesh, uvs, std::vector<float>(mesh->triangleCount(), kNoFold), size);
        Result<SurfaceFlow> made = SurfaceFlow::create(*device, std::move(*mesh), params);
        EXPECT_TRUE(made);
        flow = std::make_unique<SurfaceFlow>(std::move(*made));
        Result<FlowMaps> drawn = FlowMaps::create(*flow, uvs, size);
        EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message);
        maps = std::make_unique<FlowMaps>(std::move(*drawn));
    }

    std::vector<vec4> texels(int mip = 0) const {
        const size_t edge = static_cast<size_t>(maps->size() >> mip);
        std::vector<uint32_t> words(2 * edge * edge);
        device->read(maps->texels(), std::as_writable_bytes(std::span(words)), maps->texelsBefore(mip) * 8);
        std::vector<vec4> all;
        for (size_t k = 0; k < edge * edge; ++k) {
            const vec2 low = glm::unpackHalf2x16(words[2 * k]), high = glm::unpackHalf2x16(words[2 * k + 1]);
            all.emplace_back(low, high);
        }
        return all;
    }

    struct Place {
        size_t at;  // in texels()
        SkinPoint on;
        vec3 x;
        dvec3 alongU, alongV;  // m a unit of u, v
        double area;           // m^2
    };
    // Texels in their triangle, where the skin is at rest.
    std::vector<Place> places() const {
        std::vector<Place> all;
        const FlowMesh& m = flow->mesh();
        for (size_t k = 0; k < layout.texel.size(); ++k) {
            const uint32_t word = layout.texel[k], where = layout.tile[TILE_UINTS * (k / TILE_TEXELS)];
            if (word == TEXEL_NONE) continue;
            const int x = static_cast<int>((where & 0xFFFFU) * 8 + k % 8), y = static_cast<int>((where >> 16U) * 8 + k % 64 / 8);
            const SkinPoint p = skinPointOf(layout, word, x, y);
            if (std::min({p.b1, p.b2, 1 - p.b1 - p.b2}) < -1e-4F) continue;
            const vec4 slope = layout.chart[2 * size_t{p.triangle}];
            const dvec3 a(m.rest[m.corner[3 * p.triangle]]), e1 = dvec3(m.rest[m.corner[3 * p.triangle + 1]]) - a,
                                                             e2 = dvec3(m.rest[m.corner[3 * p.triangle + 2]]) - a;
            const dvec3 u = e1 * double{slope.x} + e2 * double{slope.y}, v = e1 * double{slope.z} + e2 * double{slope.w};
            const double size = maps->size();
            all.push_back({static_cast<size_t>(y) * static_cast<size_t>(maps->size()) + static_cast<size_t>(x), p, positionOf(m, p), u, v,
                           glm::length(glm::cross(u, v)) / (size * size)});
        }
        return all;
    }
    double drawnVolume() const {
        const std::vector<vec4> all = texels();
        double volume = 0;
        for (const Place& p : places()) volume += double{all[p.at].z} * 1e-3 * p.area;
        return volume;
    }
    void stand() { EXPECT_TRUE(flow->step({.gravity = vec3(0.0F)}, 1.0 / 60)); }
};

inline SurfaceFlowParams still() {
    SurfaceFlowParams p;
    p.trail = p.evaporation = 0;
    p.touch = 0.1F;  // drops that overlap do not merge
    return p;
}

}  // namespace rivulet::test
