// A flow drawn into UV maps: no volume is lost at seams, slopes are those of the heights, and a drop is drawn on its own skin only.
#include <gtest/gtest.h>

#include <glm/packing.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include "engine/compute/device_cpu.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/map_texels.h"
#include "fluid/flow/skin_folds.h"
#include "fluid/flow/thesis_picture.h"
#include "fluid/flow/unwrap.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "shaders/flow/map_step.h"
#include "tests/physics/charted_skins.h"
#include "tests/physics/drawn_maps.h"
#include "tests/physics/worlds.h"

namespace rivulet::flow_maps_test {
namespace {

using test::addSheet;
using test::Drawn;
using test::kMicrolitre;
using test::Skin;
using test::still;

// A ball whose left half shares its texels with the right one, as of a mirrored head: with new UVs all of the volume is drawn, on the
// mesh's own it is not, and drops move alike on both.
TEST(FlowMaps, OnOverlappingUvsNewOnesShowAllTheVolume) {
    Skin folded = test::cubeBall(0.03F, 12);
    for (vec2& uv : folded.uvs) uv.x = std::abs(uv.x - 0.505F);
    vec3 ends[2];
    for (const bool checked : {true, false}) {
        Drawn d(folded, 512, still(), checked);
        EXPECT_EQ(checkUvs(d.flow->mesh(), d.uvs, 512).usable(), checked);
        for (const vec3& x : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0.1F), vec3(0.2F, 0, 1), vec3(-0.5F, -0.5F, -0.6F)})
            d.flow->add(nearestPoint(d.flow->mesh(), 0.03F * glm::normalize(x)), 6 * kMicrolitre);
        d.stand();
        d.maps->draw(*d.flow);
        const SurfaceFlow::Ledger ledger = d.flow->ledger();
        EXPECT_EQ(ledger.drops, 30U * kMicrolitre);
        EXPECT_EQ(ledger.added, ledger.drops + ledger.film + ledger.left + ledger.evaporated);
        if (checked)
            EXPECT_NEAR(d.drawnVolume() / 30e-9, 1, 0.01);
        else
            EXPECT_LT(d.drawnVolume() / 30e-9, 0.9);
        for (int k = 0; k < 20; ++k) EXPECT_TRUE(d.flow->step({}, 1.0 / 60));
        ends[checked ? 1 : 0] = d.flow->drops()[0].position;
    }
    EXPECT_EQ(ends[0], ends[1]);
}

// Slopes equal differences of heights between neighbouring texels, also across a seam.
TEST(FlowMaps, SlopesAreThoseOfTheHeights) {
    const Skin skin = test::cubeBall(0.03F, 12);
    Drawn d(skin, 1024, still());
    for (const vec3& x : {vec3(0.03F, 0, 0), vec3(0.03F, 0.03F, 0.002F), vec3(-0.02F, 0.02F, 0.021F)})
        d.flow->add(nearestPoint(d.flow->mesh(), 0.03F * glm::normalize(x)), 8 * kMicrolitre);
    d.stand();
    d.maps->draw(*d.flow);
    const std::vector<vec4> texels = d.texels();
    double worst = 0;
    size_t compared = 0;
    std::vector<const Drawn::Place*> where(texels.size(), nullptr);
    const std::vector<Drawn::Place> places = d.places();
    for (const Drawn::Place& p : places) where[p.at] = &p;
    for (const Drawn::Place& p : places) {
        const size_t x = p.at % 1024, step = 3;
        if (x < step || x + step >= 1024) continue;
        const Drawn::Place *left = where[p.at - step], *right = where[p.at + step];
        if (!left || !right) continue;
        // All under one drop, on one triangle: the cap is smooth there.
        if (left->on.triangle != p.on.triangle || right->on.triangle != p.on.triangle) continue;
        if (texels[left->at].z < 0.25F || texels[right->at].z < 0.25F) continue;
        const double difference = double{texels[right->at].z - texels[left->at].z} * 1e-3 / (2.0 * step / 1024);
        worst = std::max(worst, std::abs(difference - double{texels[p.at].x}) / (0.47 * glm::length(p.alongU)));
        ++compared;
    }
    EXPECT_GT(compared, 1000U);
    EXPECT_LT(worst, 0.02);  // of a cap's steepest slope; half floats resolve 0.1 % of the height
}

TEST(FlowMaps, NoVolumeIsLostAtSeams) {
    struct Row {
        const char* name;
        Skin skin;
        double radius;
        int drops;
    };
    const Skin ball = test::cubeBall(0.04F, 16);
    const Row rows[] = {
        {"cube-charted ball", ball, 0.04, 60}, {"shattered ball", test::shattered(ball), 0.04, 60}, {"head", test::headSkin(), 0, 400}};
    for (const Row& row : rows) {
        ASSERT_FALSE(row.skin.indices.empty()) << row.name;
        Drawn d(row.skin, 1024, still());
        std::mt19937 random(5);
        std::uniform_real_distribution<float> any(-1.0F, 1.0F);
        std::uniform_int_distribution<uint32_t> volume(kMicrolitre, 4 * kMicrolitre);
        // Weighted by area; on the head not near an open edge, where a part would lie outside.
        const FlowMesh& m = d.flow->mesh();
        std::vector<double> area;
        double sum = 0;
        for (size_t t = 0; t < m.triangleCount(); ++t) {
            const vec3 a = m.rest[m.corner[3 * t]];
            area.push_back(sum += glm::length(glm::cross(m.rest[m.corner[3 * t + 1]] - a, m.rest[m.corner[3 * t + 2]] - a)));
        }
        std::vector<vec3> edge;
        for (size_t k = 0; k < m.across.size(); ++k)
            if (m.across[k] == FlowMesh::kOpen) edge.push_back(m.rest[m.corner[k]]);
        for (int k = 0; k < row.drops;) {
            const double pick = (0.5 + 0.5 * double{any(random)}) * sum;
            const auto t = static_cast<uint32_t>(std::lower_bound(area.begin(), area.end(), pick) - area.begin());
            if (t >= m.triangleCount()) continue;
            const SkinPoint at{t, 1.0F / 3, 1.0F / 3};
            const vec3 x = positionOf(m, at);
            if (std::any_of(edge.begin(), edge.end(), [&](const vec3& e) { return glm::distance(e, x) < 3e-3F; })) continue;
            d.flow->add(at, volume(random));
            ++k;
        }
        d.stand();
        d.maps->draw(*d.flow);
        const SurfaceFlow::Ledger ledger = d.flow->ledger();
        EXPECT_NEAR(d.drawnVolume() / (ledger.drops * 1e-15), 1, 0.005) << row.name;
    }
}

// A sheet in one chart, and the same sheet cut into charts that are moved by whole texels, rotated and mirrored: positions in space and the
// mass are the same.
TEST(FlowMaps, TheSameMassInEveryLayout) {
    const vec3 across(0.032F, 0, 0), along(0, 0.032F, 0);
    Skin whole, cut;
    addSheet(whole, vec3(0), across, along, 8, vec2(0.25F), vec2(0.5F, 0), vec2(0, 0.5F));
    // Four quarters, each 0.25 of the map wide: as it is, turned by a right angle, mirrored, upside down.
    const vec2 at[4] = {{0.0625F, 0.0625F}, {0.4375F, 0.5625F}, {0.9375F, 0.0625F}, {0.9375F, 0.9375F}};
    const vec2 u[4] = {{0.25F, 0}, {0, 0.25F}, {-0.25F, 0}, {-0.25F, 0}}, v[4] = {{0, 0.25F}, {-0.25F, 0}, {0, 0.25F}, {0, -0.25F}};
    for (uint32_t k = 0; k < 4; ++k)
        addSheet(cut, 0.5F * (across * (k % 2 == 1 ? 1.0F : 0.0F) + along * (k > 1 ? 1.0F : 0.0F)), 0.5F * across, 0.5F * along, 4, at[k],
                 u[k], v[k]);
    double volume[2] = {};
    for (int k = 0; k < 2; ++k) {
        Drawn d(k == 0 ? whole : cut, 512, still());
        ASSERT_EQ(d.flow->mesh().report.components, 1U);
        for (const vec3& x : {vec3(0.016F, 0.016F, 0), vec3(0.0101F, 0.0163F, 0), vec3(0.0163F, 0.025F, 0), vec3(0.007F, 0.006F, 0)})
            d.flow->add(nearestPoint(d.flow->mesh(), x), 3 * kMicrolitre);
        d.stand();
        d.maps->draw(*d.flow);
        volume[k] = d.drawnVolume();
    }
    EXPECT_NEAR(volume[1] / volume[0], 1, 1e-6);
    EXPECT_NEAR(volume[0] / 12e-9, 1, 1e-3);
}

// Far from the box that the skin has at rest, the same texels show the same drops.
TEST(FlowMaps, FarFromTheRestPoseTheSameIsDrawn) {
    const Skin ball = test::cubeBall(0.03F, 16);
    std::vector<vec4> atRest;
    for (const vec3& away : {vec3(0.0F), vec3(0.0F, 0.11F, 0.0F), vec3(8.0F, -2.0F, 4.0F)}) {
        Drawn d(ball, 512, still());
        std::mt19937 random(5);
        std::uniform_real_distribution<float> any(-1.0F, 1.0F);
        for (int k = 0; k < 40; ++k)
            d.flow->add(nearestPoint(d.flow->mesh(), 0.03F * glm::normalize(vec3(any(random), any(random), any(random)))), kMicrolitre);
        std::vector<vec3> moved = ball.positions;
        for (vec3& x : moved) x += away;
        EXPECT_TRUE(d.flow->step({.gravity = vec3(0.0F), .positions = moved}, 1.0 / 60));
        d.maps->draw(*d.flow);
        EXPECT_NEAR(d.drawnVolume() / (40 * kMicrolitre * 1e-15), 1, 0.01);
        if (atRest.empty()) atRest = d.texels();
        const std::vector<vec4> all = d.texels();
        size_t differ = 0;
        for (size_t k = 0; k < all.size(); ++k) differ += std::abs(all[k].z - atRest[k].z) > 0.01F ? 1 : 0;  // mm
        EXPECT_EQ(differ, 0U) << away.x;
    }
}

// Two lips a third of a millimetre apart that are connected far away: a drop on one leaves the other dry. A drop on a thin leaf leaves its
// other side dry.
TEST(FlowMaps, TheOtherLipStaysDry) {
    Skin lips;
    addSheet(lips, vec3(0, 0.00015F, 0), vec3(0.03F, 0, 0), vec3(0, 0.01485F, 0), 12, vec2(0.05F, 0.52F), vec2(0.9F, 0), vec2(0, 0.43F));
    addSheet(lips, vec3(0, -0.015F, 0), vec3(0.03F, 0, 0), vec3(0, 0.01485F, 0), 12, vec2(0.05F, 0.05F), vec2(0.9F, 0), vec2(0, 0.43F));
    // A leaf, its sides 0.8 mm apart, closed by a narrow strip along one edge.
    Skin leaf;
    addSheet(leaf, vec3(0, 0, 0.0004F), vec3(0.03F, 0, 0), vec3(0, 0.03F, 0), 12, vec2(0.03F, 0.05F), vec2(0.45F, 0), vec2(0, 0.9F));
    addSheet(leaf, vec3(0, 0.03F, -0.0004F), vec3(0.03F, 0, 0), vec3(0, -0.03F, 0), 12, vec2(0.52F, 0.05F), vec2(0.45F, 0), vec2(0, 0.9F));
    for (uint32_t k = 0; k < 12; ++k) {
        const uint32_t a = 12 * 13 + k, b = a + 1, c = 13 * 13 + k, d = c + 1;  // the first one's last row, the second one's first
        leaf.indices.insert(leaf.indices.end(), {a, b, d, a, d, c});
    }
    struct Row {
        const Skin& skin;
        vec3 drop;
    };
    for (const Row& row :
         {Row{lips, vec3(0.015F, 0.0012F, 0)}, Row{lips, vec3(0.015F, -0.0008F, 0)}, Row{leaf, vec3(0.015F, 0.012F, 0.0004F)}}) {
        Drawn d(row.skin, 512, still());
        const SkinPoint home = nearestPoint(d.flow->mesh(), row.drop);
        d.flow->add(home, 4 * kMicrolitre);
        d.stand();
        d.maps->draw(*d.flow);
        const std::vector<vec4> texels = d.texels();
        double own = 0, other = 0;
        for (const Drawn::Place& p : d.places()) {
            const bool same = &row.skin == &leaf ? p.x.z > 0 : (p.x.y > 0) == (row.drop.y > 0);
            (same ? own : other) += double{texels[p.at].z} * p.area;
        }
        EXPECT_GT(own, 0);
        EXPECT_LT(other, 1e-3 * own) << row.drop.y;
    }
}

// Two sheets at a varying distance. One triangle of the search stands for many of the fine skin: the stored distance is accurate to half of
// the reach, never too large, and absent where no skin is near.
TEST(FlowMaps, AFineSkinStoresDistancesToNearSkin) {
    constexpr float kReach = 0.004F;
    Skin skin;
    addSheet(skin, vec3(0), vec3(0.03F, 0, 0), vec3(0, 0.012F, 0), 90, vec2(0), vec2(0.4F, 0), vec2(0, 1));
    // Above it, facing it: 0.2 mm off at one end, 8 mm at the other.
    addSheet(skin, vec3(0, 0.012F, 0.0002F), vec3(0.03F, 0, 0.0078F), vec3(0, -0.012F, 0), 90, vec2(0.5F, 0), vec2(0.4F, 0), vec2(0, 1));
    Result<FlowMesh> mesh = makeFlowMesh(skin.view());
    ASSERT_TRUE(mesh);
    const std::vector<float> folds = skinFolds(*mesh, kReach);
    size_t near = 0, none = 0;
    for (uint32_t t = 0; t < mesh->triangleCount(); ++t) {
        const vec3 x = positionOf(*mesh, {t, 1.0F / 3, 1.0F / 3});
        if (x.z > 0 || x.x > 0.0295F) continue;  // of the lower sheet, not at its end
        const float slope = 0.0078F / 0.03F, apart = (0.0002F + slope * x.x) / std::sqrt(1 + slope * slope);
        if (x.x > 0.0295F - slope * 0.0078F) continue;  // the nearest point would be beyond the other's end
        if (apart < kReach) {
            ++near;
            EXPECT_LE(folds[t], apart + 1e-5F) << x.x;
            EXPECT_GE(folds[t], apart - 0.51F * kReach - 1e-4F) << x.x;
        } else if (apart > 1.6F * kReach) {
            ++none;
            EXPECT_EQ(folds[t], kNoFold) << x.x;
        }
    }
    EXPECT_GT(near, 5000U);
    EXPECT_GT(none, 500U);
}

// A drop has run down a sheet and left it: its film is drawn completely and in place, and is wet where it belongs to the trail.
TEST(FlowMaps, TheFilmIsDrawnWhereItLies) {
    Skin skin;
    addSheet(skin, vec3(0), vec3(0.02F, 0, 0), vec3(0, 0.04F, 0), 16, vec2(0.05F, 0.05F), vec2(0.45F, 0), vec2(0, 0.9F));
    SurfaceFlowParams p;
    p.evaporation = 0;
    p.hold = 0;
    p.pearls = false;  // it runs at 0.3 m/s
    Drawn d(skin, 512, p);
    d.flow->add(nearestPoint(d.flow->mesh(), vec3(0.01F, 0.036F, 0)), 8 * kMicrolitre);
    for (int k = 0; k < 120; ++k) {
        EXPECT_TRUE(d.flow->step({}, 1.0 / 60));
        d.maps->draw(*d.flow);
    }
    const SurfaceFlow::Ledger ledger = d.flow->ledger();
    ASSERT_EQ(ledger.drops, 0U);
    EXPECT_NEAR(d.drawnVolume() / (ledger.film * 1e-15), 1, 0.01);
    const std::vector<vec4> texels = d.texels();
    double thick = 0, wet = 0, beside = 0, n = 0;
    for (const Drawn::Place& place : d.places()) {
        const float aside = std::abs(place.x.x - 0.01F);
        const vec4 t = texels[place.at];
        if (aside > 0.004F) beside = std::max(beside, double{t.z});
        if (aside > 0.0005F || place.x.y < 0.003F || place.x.y > 0.034F) continue;
        thick += double{t.z};
        wet += double{t.w};
        ++n;
    }
    EXPECT_EQ(beside, 0);
    // Ten micrometres.
    EXPECT_NEAR(thick / n, 0.01, 0.0005);
    EXPECT_GT(wet / n, 0.95);
}

// Maps updated tile by tile over many frames equal maps drawn at once, and mips are means over the skin in them.
TEST(FlowMaps, UnchangedTilesEqualARedraw) {
    const Skin skin = test::cubeBall(0.03F, 12);
    SurfaceFlowParams p;
    p.evaporation = 0;
    Drawn d(skin, 256, p);
    for (const vec3& x : {vec3(1, 1, 0), vec3(0.9F, 1, 0.5F), vec3(-1, 2, 0.3F)})
        d.flow->add(nearestPoint(d.flow->mesh(), 0.03F * glm::normalize(x)), 6 * kMicrolitre);
    for (int k = 0; k < 90; ++k) {
        EXPECT_TRUE(d.flow->step({}, 1.0 / 60));
        d.maps->draw(*d.flow);
    }
    Result<FlowMaps> anew = FlowMaps::create(*d.flow, d.uvs, 256);
    ASSERT_TRUE(anew);
    anew->draw(*d.flow);
    const std::vector<vec4> before = d.texels();
    d.maps = std::make_unique<FlowMaps>(std::move(*anew));
    const std::vector<vec4> after = d.texels();
    double wet = 0;
    size_t differ = 0;
    for (size_t k = 0; k < after.size(); ++k) {
        wet += double{after[k].w};
        differ += before[k] == after[k] ? 0 : 1;
    }
    EXPECT_GT(wet, 200);
    EXPECT_EQ(differ, 0U);
    // Charts are far enough apart that at mip 2 none meets another.
    std::vector<char> skinned(256 * 256, 0);
    for (size_t k = 0; k < d.layout.texel.size(); ++k) {
        const uint32_t where = d.layout.tile[TILE_UINTS * (k / TILE_TEXELS)];
        if (d.layout.texel[k] != TEXEL_NONE) skinned[((where >> 16U) * 8 + k % 64 / 8) * 256 + (where & 0xFFFFU) * 8 + k % 8] = 1;
    }
    for (int mip = 1; mip <= 8; ++mip) {
        const std::vector<vec4> level = d.texels(mip);
        const size_t edge = size_t{256} >> static_cast<size_t>(mip), step = size_t{1} << static_cast<size_t>(mip);
        for (size_t y = 0; y < edge; ++y)
            for (size_t x = 0; x < edge; ++x) {
                dvec3 sum(0.0);
                double n = 0;
                for (size_t k = 0; k < step * step; ++k) {
                    const size_t at = (y * step + k / step) * 256 + x * step + k % step;
                    n += skinned[at];
                    if (skinned[at]) sum += dvec3(after[at].x, after[at].z, after[at].w);
                }
                const vec4 got = level[y * edge + x];
                const dvec3 mean = sum / std::max(n, 1.0);
                EXPECT_NEAR(got.x, mean.x, 2e-4 + 2e-3 * std::abs(mean.x));
                EXPECT_NEAR(got.z, mean.y, 1e-4 + 2e-3 * mean.y);
                EXPECT_NEAR(got.w, mean.z, 1e-4 + 2e-3 * mean.z);
            }
    }
}

TEST(FlowMaps, InvalidMapsAreRefused) {
    const Skin skin = test::cubeBall(0.03F, 3);
    auto device = cpu();
    Result<FlowMesh> mesh = makeFlowMesh(skin.view());
    ASSERT_TRUE(mesh);
    std::vector<vec2> uvs = cornerUvs(*mesh, skin.view());
    Result<SurfaceFlow> flow = SurfaceFlow::create(*device, std::move(*mesh), {});
    ASSERT_TRUE(flow);
    for (const int size : {0, -4, 8, 100, 65536}) {
        Result<FlowMaps> maps = FlowMaps::create(*flow, uvs, size);
        ASSERT_FALSE(maps) << size;
        EXPECT_NE(maps.error().message.find("power of two"), std::string::npos) << maps.error().message;
    }
    EXPECT_FALSE(FlowMaps::create(*flow, std::span(uvs).first(7), 64));
    // Triangles with NaN UVs are not drawn; the others are.
    for (size_t k = 0; k < uvs.size() / 2; ++k) uvs[k] = k % 2 == 0 ? vec2(NAN, 1e30F) : vec2(0.3F);
    Result<FlowMaps> half = FlowMaps::create(*flow, uvs, 64);
    ASSERT_TRUE(half);
    flow->add({30, 0.3F, 0.3F}, 5 * kMicrolitre);
    EXPECT_TRUE(flow->step({.wind = vec3(1e3F, 0, 0)}, 1.0 / 60));
    EXPECT_FALSE(flow->step({.wind = vec3(1e6F, 0, 0)}, 1.0 / 60));
    half->draw(*flow);
    for (const uint32_t word : device->readAll<uint32_t>(half->texels(), 2 * 64 * 64)) {
        EXPECT_LT(word & 0x7C00U, 0x7C00U);  // no Inf
        EXPECT_LT(word >> 16U & 0x7C00U, 0x7C00U);
    }
    Result<FlowMesh> again = makeFlowMesh(skin.view());
    const std::vector<vec2> own = cornerUvs(*again, skin.view());
    Result<SurfaceFlow> thesis = SurfaceFlow::createThesis(*device, std::move(*again), own, {}, {});
    ASSERT_TRUE(thesis) << thesis.error().message;
    EXPECT_FALSE(FlowMaps::create(*thesis, own, 64));
    for (vec2& uv : uvs) uv = vec2(0.5F);
    Result<FlowMaps> none = FlowMaps::create(*flow, uvs, 64);
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("unwrap"), std::string::npos);
}

// The thesis's picture, (22) and (23): a disc as printed, with normals that point away from its centre. Its defect shows on a chart that is
// stretched four times along v: its drop is four times as long as wide, Rivulet's is round.
TEST(FlowMaps, TheThesissPictureIsStretchedWithItsChart) {
    const int size = 256;
    const ThesisParticle drop{vec2(128.5F / 256), 1.0F};
    const ThesisPicture alone = thesisPicture(std::span(&drop, 1), size, 0.05F, 1.0F);
    const auto at = [](int x, int y) { return static_cast<size_t>(y) * size + static_cast<size_t>(x); };
    EXPECT_FLOAT_EQ(alone.height[at(128, 128)], 1);
    EXPECT_NEAR(alone.height[at(128 + 6, 128)], std::pow(1 - 36 / (12.8 * 12.8), 3), 1e-5);
    EXPECT_EQ(alone.height[at(128 + 13, 128)], 0);
    EXPECT_GT(alone.normal[at(133, 128)].x, 0.1F);
    EXPECT_LT(alone.normal[at(123, 128)].x, -0.1F);
    EXPECT_NEAR(alone.normal[at(128, 133)].x, 0, 0.1);
    EXPECT_EQ(alone.normal[at(20, 20)], vec3(0, 0, 1));
    const ThesisParticle pair[] = {drop, {drop.uv + vec2(0.01F, 0), 0.5F}};
    EXPECT_GT(thesisPicture(pair, size, 0.05F, 1.0F).height[at(128, 128)], 1.1F);

    // Length over width of a drop in metres, by second moments.
    const auto stretch = [&](const Drawn& d, auto&& heightAt) {
        dvec2 moment(0.0);
        const vec3 middle(0.01F, 0.02F, 0);
        for (const Drawn::Place& p : d.places()) {
            const dvec3 off = dvec3(p.x - middle);
            moment += heightAt(p.at) * p.area * dvec2(off.x * off.x, off.y * off.y);
        }
        return std::sqrt(moment.y / moment.x);
    };
    Skin skin;
    addSheet(skin, vec3(0), vec3(0.02F, 0, 0), vec3(0, 0.04F, 0), 8, vec2(0.1F, 0.3F), vec2(0.8F, 0), vec2(0, 0.4F));
    Drawn d(skin, size, still());
    d.flow->add(nearestPoint(d.flow->mesh(), vec3(0.01F, 0.02F, 0)), 2 * kMicrolitre);
    d.stand();
    d.maps->draw(*d.flow);
    const std::vector<vec4> ours = d.texels();
    const ThesisParticle same{vec2(0.5F), 1.0F};
    const ThesisPicture theirs = thesisPicture(std::span(&same, 1), size, 0.03F, 1.0F);
    EXPECT_NEAR(stretch(d, [&](size_t k) { return double{ours[k].z}; }), 1, 0.03);
    EXPECT_NEAR(stretch(d, [&](size_t k) { return double{theirs.height[k]}; }), 4, 0.05);
}

}  // namespace
}  // namespace rivulet::flow_maps_test
