// Small worlds of skins: meshes that deform, and drops on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "engine/scene/skin.h"
#include "fluid/flow/flow_maps.h"
#include "tests/physics/charted_skins.h"
#include "tests/races/small_worlds_parts.h"

namespace rivulet::races {

// A ball whose halves two bones turn, with a morph.
Answer skin(Device& device) {
    ModelPart part;
    part.name = "ball";
    const test::Skin ball = test::cubeBall(1.0F, 4);
    part.mesh.positions = ball.positions;
    part.mesh.indices = ball.indices;
    part.bones = {{0, mat4(1.0F)}, {0, mat4(1.0F)}};
    MorphTarget wide{"wide", {}, {}};
    for (uint32_t i = 0; i < ball.positions.size(); ++i) {
        wide.vertices.push_back(i);
        wide.offsets.push_back(0.3F * ball.positions[i]);
        part.grips.push_back({{0, 1, 0, 0}, {0.4F, 0.6F, 0, 0}});
    }
    part.morphs = {wide};
    Answer a;
    Result<Deformer> made = Deformer::create(device, part);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    if (!made) return a;
    mat4 moved(1.0F);
    moved[3] = vec4(0.1F, 0.2F, 0.0F, 1.0F);
    const float weights[] = {0.5F};
    const mat4 bones[] = {mat4(1.0F), moved};
    made->run(weights, bones);
    for (const Buffer* buffer : {&made->positions(), &made->normals()})
        for (const vec4& v : device.readAll<vec4>(*buffer, made->vertices())) add(a.exact, v);
    return a;
}

namespace {

// The drops of a flow, whose ids are slots: by what is theirs. `painting`: they leave trails. Two drops that paint a cell share it by their
// order, which is then noise in volumes: 2.8 % at most was seen. Without trails all is exact; on a GPU to rounding, since the order gives
// drops their ids, in whose order sums are.
void addDrops(const SurfaceFlow& flow, Answer& a, bool painting, bool onCpu) {
    std::vector<vec4> drops;
    for (const SkinDrop& d : flow.drops()) drops.emplace_back(20.0F * d.position, static_cast<float>(d.volume * 1e9));
    std::sort(drops.begin(), drops.end(), [](const vec4& one, const vec4& other) {
        return std::tie(one.w, one.x, one.y, one.z) < std::tie(other.w, other.x, other.y, other.z);
    });
    if (!painting)
        for (const vec4& d : drops) add(onCpu ? a.exact : a.near, d);
    dvec3 middle(0.0);
    double sum = 0, square = 0;
    for (const vec4& d : drops) {
        middle += dvec3(d) * double{d.w};
        sum += double{d.w};
        square += double{d.w} * double{d.w};
    }
    EXPECT_FALSE(drops.empty());
    add(a.near, vec3(middle / std::max(sum, 1.0e-9)));
    a.near.push_back(static_cast<float>(0.1 * sum));
    a.near.push_back(static_cast<float>(0.01 * square));
    const SurfaceFlow::Ledger ledger = flow.ledger();
    EXPECT_EQ(ledger.added, ledger.drops + ledger.film + ledger.left + ledger.evaporated + ledger.refused);
    a.near.push_back(static_cast<float>(1.0e-8 * static_cast<double>(ledger.film)));
    a.near.push_back(static_cast<float>(1.0e-8 * static_cast<double>(ledger.left)));
    a.within = painting ? 0.03 : onCpu ? 1.0e-6 : 1.0e-4;
}
Answer flowOnBall(Device& device, bool painting) {
    Answer a;
    const test::Skin skin = test::cubeBall(0.03F, 6);
    Result<FlowMesh> mesh = makeFlowMesh(skin.view());
    EXPECT_TRUE(mesh);
    const std::vector<vec2> uvs = cornerUvs(*mesh, skin.view());
    SurfaceFlowParams p;
    p.capacity = 256;
    p.filmCell = 0.002F;
    if (!painting) p.trail = 0;
    SkinBrim brim;
    for (int k = 0; k < 4; ++k) {
        const vec3 x = 0.03F * glm::normalize(vec3(1, 0.1F, -0.3F + 0.2F * static_cast<float>(k)));
        brim.places.push_back(nearestPoint(*mesh, x));
        brim.spills.push_back(nearestPoint(*mesh, x - vec3(0, 0.004F, 0)));
    }
    brim.picolitres = 9000000;
    Result<SurfaceFlow> made = SurfaceFlow::create(device, std::move(*mesh), p, std::span(&brim, 1));
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    if (!made) return a;
    Result<FlowMaps> maps = FlowMaps::create(*made, uvs, 32);
    EXPECT_TRUE(maps) << (maps ? "" : maps.error().message);
    if (!maps) return a;
    for (const vec3& x :
         {vec3(1, 1.1F, 0.2F), vec3(1, 1.0F, 0.3F), vec3(0.2F, 1, 1.3F), vec3(-1, 2, 0.3F), vec3(1, 0, 1), vec3(0, -1, 0.1F)})
        made->add(nearestPoint(made->mesh(), 0.03F * glm::normalize(x)), 17000000, vec3(0, -0.3F, 0));
    for (int k = 0; k < 12; ++k)
        made->add(nearestPoint(made->mesh(), 0.03F * glm::normalize(vec3(-1, 0.3F, 0.05F * static_cast<float>(k)))), 3000000, vec3(0.0F),
                  true);
    std::vector<vec3> places(made->mesh().rest.size() == 0 ? 0 : skin.positions.size());
    for (int k = 0; k < 5; ++k) {
        for (size_t i = 0; i < places.size(); ++i) places[i] = skin.positions[i] * (1.0F + 0.01F * static_cast<float>(k));
        if (k == 4) places.clear();  // the skin stands still
        EXPECT_TRUE(made->step({.wind = vec3(1, 0, 0), .positions = places}, 1.0 / 60));
        device.finish();
        device.poll();
        maps->draw(*made);
    }
    addDrops(*made, a, painting, device.backend() == Backend::cpu);
    const std::vector<uint32_t> words = device.readAll<uint32_t>(maps->texels(), maps->texels().bytes() / 4);
    EXPECT_TRUE(std::ranges::any_of(words, [](uint32_t w) { return w != 0; }));
    return a;
}

}  // namespace

Answer flow(Device& device) { return flowOnBall(device, true); }
Answer flowWithoutTrails(Device& device) { return flowOnBall(device, false); }
Answer thesisFlow(Device& device) {
    Answer a;
    const Shape cone = coneShape(0.05F, 0.03F, 0.1F, 16, 8);
    Result<FlowMesh> mesh = makeFlowMesh(cone.view());
    EXPECT_TRUE(mesh);
    const std::vector<vec2> uvs = cornerUvs(*mesh, cone.view());
    SurfaceFlowParams p;
    p.capacity = 256;
    Result<SurfaceFlow> made = SurfaceFlow::createThesis(device, std::move(*mesh), uvs, p, {});
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    if (!made) return a;
    for (int k = 0; k < 6; ++k) {
        for (const double at : {0.9 + 0.004 * k, 0.93 + 0.003 * k, 1.5})
            made->add(nearestPoint(made->mesh(), vec3(dvec3(0.04 * std::cos(at), 0.09, 0.04 * std::sin(at)))), 900000 + 40000 * (k % 7));
        EXPECT_TRUE(made->step({.wind = vec3(1, 0, 0)}, 1.0 / 60));
        device.finish();
        device.poll();
    }
    addDrops(*made, a, false, device.backend() == Backend::cpu);
    return a;
}

}  // namespace rivulet::races
