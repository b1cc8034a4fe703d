// Water in a host's picture by any camera: each is the picture of a plain camera, mirrored if the camera mirrors.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "engine/gpu/host_state.h"
#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "fluid/render/water_renderer.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/host_water.h"

namespace rivulet::any_view_test {
namespace {

using testing::HostScene;
constexpr int kWidth = 200, kHeight = 150;

struct Drawn {
    std::vector<vec4> pixels, before;
    std::vector<vec3> places, placesBefore;
    void mirror(bool x, bool y) {
        for (int row = 0; row < kHeight && x; ++row) {
            const auto at = [&](auto& all) { std::reverse(all.begin() + row * kWidth, all.begin() + (row + 1) * kWidth); };
            at(pixels), at(before), at(places), at(placesBefore);
        }
        for (int row = 0; row < kHeight / 2 && y; ++row) {
            const auto at = [&](auto& all) {
                std::swap_ranges(all.begin() + row * kWidth, all.begin() + (row + 1) * kWidth, all.begin() + (kHeight - 1 - row) * kWidth);
            };
            at(pixels), at(before), at(places), at(placesBefore);
        }
    }
};

class WaterInAnyView : public testing::HostWater {
  protected:
    WaterInAnyView() : HostWater(8) {}
    void TearDown() override {
        for (gpu::Buffer* buffer : {&drops_, &foam_[0], &foam_[1], &pendants_}) *buffer = {};
        HostWater::TearDown();
    }
    // Files of this name go to $RIVULET_PICTURES, for a person to look at.
    Drawn draw(const char* name, const HostScene::Options& options, const RendererRow* row = nullptr, const FluidLook& look = {}) {
        glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        const HostScene host(kWidth, kHeight, options);
        Drawn drawn;
        drawn.before = host.pixels();
        drawn.placesBefore = host.places();
        FluidView fluid = testing::viewOf(*world_);
        if (drops_) {
            fluid.drops = drops_.name();
            fluid.dropCount = 1;
            fluid.foam = {foam_[0].name(), foam_[1].name()};
            fluid.foamCount = 1;
            fluid.pendants = pendants_.name();
            fluid.pendantCount = 1;
        }
        const Status done = renderer_->draw(host.view(), fluid, look, host.target(), row);
        EXPECT_TRUE(done) << name << ": " << done.error().message;
        drawn.pixels = host.pixels();
        drawn.places = host.places();
        testing::keepPicture(name, drawn.pixels, kWidth, kHeight);
        return drawn;
    }
    // `colours`: mean over the picture, of 1. `far`: share of the pixels whose place differs by more than 2 cm.
    static void expectAlike(const Drawn& a, const Drawn& b, double colours, double far) {
        double sum = 0, host = 0;
        size_t off = 0, water = 0;
        for (size_t k = 0; k < a.pixels.size(); ++k) {
            sum += glm::dot(glm::abs(vec3(a.pixels[k]) - vec3(b.pixels[k])), vec3(1.0F / 3));
            host += glm::dot(glm::abs(vec3(a.before[k]) - vec3(b.before[k])), vec3(1.0F / 3));
            water += a.pixels[k] != a.before[k] ? 1 : 0;
            // Beyond 10 m there is nothing.
            const bool there = glm::length(b.places[k]) < 10;
            off += there && !(glm::distance(a.places[k], b.places[k]) < 0.02F) ? 1 : 0;
        }
        const auto all = static_cast<double>(a.pixels.size());
        EXPECT_LT(host / all, colours) << "the test's own scene";
        EXPECT_LT(sum / all, colours);
        EXPECT_LT(static_cast<double>(off) / all, far);
        EXPECT_GT(static_cast<double>(water) / all, 0.1);
    }

    gpu::Buffer drops_, foam_[2], pendants_;
};

// Rotation of a world with +Y up into one with +Z up.
const mat4 kZUp = glm::rotate(mat4(1.0F), glm::radians(90.0F), vec3(1, 0, 0));

mat4 scaled(float x, float y, float z) { return glm::scale(mat4(1.0F), vec3(x, y, z)); }
void toCentimetres(FrameView& v) {
    v.view[3] = vec4(100.0F * vec3(v.view[3]), 1.0F);
    v.nearPlane *= 100;
    v.farPlane *= 100;
    v.unitsPerMetre = 100;
}
// The near plane is one through a point (view, m), its normal towards the scene (Lengyel 2005).
void makeOblique(mat4& projection, const vec3& through, const vec3& normal) {
    const vec4 plane(normal, -glm::dot(normal, through));
    const vec4 corner = glm::inverse(projection) * vec4(plane.x > 0 ? 1.0F : -1.0F, plane.y > 0 ? 1.0F : -1.0F, 1.0F, 1.0F);
    const vec4 row =
        plane * (2.0F / glm::dot(plane, corner)) - vec4(projection[0][3], projection[1][3], projection[2][3], projection[3][3]);
    for (int column = 0; column < 4; ++column) projection[column][2] = row[column];
}

struct Case {
    const char* name;
    bool mirrorX, mirrorY;
    std::function<void(FrameView&)> camera;
    bool upperLeft = false;
};
const Case kPerspectives[] = {
    {"mirrored_projection", false, true, [](FrameView& v) { v.projection = scaled(1, -1, 1) * v.projection; }},
    {"turned_projection", true, true, [](FrameView& v) { v.projection = scaled(-1, -1, 1) * v.projection; }},
    {"mirrored_view", true, false, [](FrameView& v) { v.view = scaled(-1, 1, 1) * v.view; }},
    {"upper_left", false, true, [](FrameView&) {}, true},
    {"left_handed", true, false,
     [](FrameView& v) {
         v.view = glm::lookAtLH(v.cameraPosWorld, vec3(0.5F, 0.25F, 0.4F), vec3(0, 1, 0));
         v.projection = glm::perspectiveLH(0.9F, static_cast<float>(kWidth) / kHeight, 0.1F, 20.0F);
     }},
    {"left_handed_same_world", false, false,
     [](FrameView& v) {
         v.view = scaled(1, 1, -1) * v.view;
         v.projection = v.projection * scaled(1, 1, -1);
     }},
    {"z_up", false, false,
     [](FrameView& v) {
         const vec3 eye(kZUp * vec4(v.cameraPosWorld, 1.0F)), centre(kZUp * vec4(0.5F, 0.25F, 0.4F, 1.0F));
         v.view = glm::lookAt(eye, centre, vec3(0, 0, 1)) * kZUp;
     }},
    {"centimetres", false, false,
     [](FrameView& v) {
         toCentimetres(v);
         v.projection = glm::perspective(0.9F, static_cast<float>(kWidth) / kHeight, 10.0F, 2000.0F);
     }},
    {"scaled_view", false, false,
     [](FrameView& v) {
         v.view = scaled(100, 100, 100) * v.view;
         v.nearPlane = 10;
         v.farPlane = 2000;
         v.projection = glm::perspective(0.9F, static_cast<float>(kWidth) / kHeight, 10.0F, 2000.0F);
     }},
    {"oblique", false, false,
     [](FrameView& v) { makeOblique(v.projection, vec3(0.0F, 0.0F, -0.5F), glm::normalize(vec3(0.3F, 0.2F, -0.93F))); }},
    {"infinite", false, false,
     [](FrameView& v) { v.projection = glm::infinitePerspective(0.9F, static_cast<float>(kWidth) / kHeight, 0.1F); }},
};

TEST_F(WaterInAnyView, IsThePictureOfAPlainOne) {
    const Drawn plain = draw("plain", {.depth = GL_DEPTH_COMPONENT32F});
    for (const Case& row : kPerspectives) {
        SCOPED_TRACE(row.name);
        Drawn other = draw(row.name, {.depth = GL_DEPTH_COMPONENT32F, .upperLeft = row.upperLeft, .camera = row.camera});
        other.mirror(row.mirrorX, row.mirrorY);
        expectAlike(other, plain, 0.0015, 0.005);
    }
}

// A mirrored camera keeps the host's alpha and its own pixels, where there is no water.
TEST_F(WaterInAnyView, LeavesTheRestAlone) {
    const auto camera = [](FrameView& v) { v.projection = scaled(1, -1, 1) * v.projection; };
    const Drawn drawn = draw("rest", {.left = 7, .bottom = 5, .camera = camera});
    size_t changed = 0;
    for (size_t k = 0; k < drawn.pixels.size(); ++k) {
        EXPECT_EQ(drawn.pixels[k].w, drawn.before[k].w);
        const bool same = drawn.pixels[k] == drawn.before[k];
        changed += same ? 0 : 1;
        if (drawn.before[k].x > 0.7F && drawn.before[k].z < 0.4F) EXPECT_TRUE(same) << "at the post before the water";
        // Sky, which here is below.
        if (k / kWidth < kHeight / 8) EXPECT_TRUE(same);
    }
    EXPECT_GT(changed, drawn.pixels.size() / 8);
}

// An orthographic camera and a perspective from far away see the same.
constexpr float kAway = 600.0F, kHalf = 0.8F;  // m: the distance; half the height of the picture
vec3 towards() { return glm::normalize(vec3(0.1F, 0.6F, 1.0F)); }
void fromFar(FrameView& v) {
    const vec3 centre(0.5F, 0.3F, 0.5F);
    v.cameraPosWorld = centre + kAway * towards();
    v.view = glm::lookAt(v.cameraPosWorld, centre, vec3(0, 1, 0));
    v.nearPlane = kAway - 4;
    v.farPlane = kAway + 16;
    v.projection = glm::perspective(2 * std::atan(kHalf / kAway), static_cast<float>(kWidth) / kHeight, v.nearPlane, v.farPlane);
}
void fromFarFlat(FrameView& v) {
    const vec3 centre(0.5F, 0.3F, 0.5F);
    v.cameraPosWorld = centre + 4.0F * towards();
    v.view = glm::lookAt(v.cameraPosWorld, centre, vec3(0, 1, 0));
    v.nearPlane = 0;
    v.farPlane = 20;
    const float wide = kHalf * static_cast<float>(kWidth) / kHeight;
    v.projection = glm::ortho(-wide, wide, -kHalf, kHalf, v.nearPlane, v.farPlane);
}

TEST_F(WaterInAnyView, IsOrthographicAsFromFarAway) {
    // With a drop in the air, a fleck of spray, and a drop that hangs.
    const auto fill = [](gpu::Buffer& buffer, const std::vector<vec4>& rows) {
        Result<gpu::Buffer> made = gpu::Buffer::from(rows);
        ASSERT_TRUE(made);
        buffer = std::move(*made);
    };
    fill(drops_, {{0.4F, 0.75F, 0.6F, 0.03F}, {0.0F, -1.0F, 0.0F, 0.0F}});
    fill(foam_[0], {{0.7F, 0.7F, 0.6F, 2.0F}});
    fill(foam_[1], {{0.5F, 0.0F, 0.0F, 1.9F}});
    fill(pendants_,
         {{0.55F, 0.8F, 0.6F, 0.06F}, {0.0F, -1.0F, 0.0F, 1.0F}, {4.0e-4F, 1.0e-3F, 2.0e-3F, 0.0F}, {0.0F, 0.0F, 0.0F, 0.03F}, {}});
    for (const char* name : {"screen_space", "points", "reference"}) {
        SCOPED_TRACE(name);
        const RendererRow* row = renderers().find(name);
        const Drawn far = draw(fmt::format("far_{}", name).c_str(), {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFar}, row);
        const Drawn flat = draw(fmt::format("orthographic_{}", name).c_str(), {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFarFlat}, row);
        expectAlike(flat, far, 0.006, 0.02);
    }
    for (const char* filter : {"bilateral", "curvature_flow", "none"}) {
        SCOPED_TRACE(filter);
        FluidLook look;
        look.filter = filters().find(filter);
        const Drawn far = draw("far", {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFar}, nullptr, look);
        const Drawn flat =
            draw(fmt::format("orthographic_{}", filter).c_str(), {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFarFlat}, nullptr, look);
        expectAlike(flat, far, 0.006, 0.02);
    }
    FluidLook fast;
    fast.fast = true;
    const Drawn far = draw("far", {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFar}, nullptr, fast);
    const Drawn flat = draw("orthographic_fast", {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFarFlat}, nullptr, fast);
    expectAlike(flat, far, 0.006, 0.02);
}

const Case kOrthographics[] = {
    {"flat_mirrored", false, true, [](FrameView& v) { v.projection = scaled(1, -1, 1) * v.projection; }},
    {"flat_left_handed", false, false,
     [](FrameView& v) {
         v.view = scaled(1, 1, -1) * v.view;
         v.projection = v.projection * scaled(1, 1, -1);
     }},
    {"flat_centimetres", false, false,
     [](FrameView& v) {
         toCentimetres(v);
         v.projection = v.projection * scaled(0.01F, 0.01F, 0.01F);
     }},
    {"flat_upper_left", false, true, [](FrameView&) {}, true},
};

TEST_F(WaterInAnyView, IsThePictureOfAPlainOrthographicOne) {
    const Drawn plain = draw("flat", {.depth = GL_DEPTH_COMPONENT32F, .camera = fromFarFlat});
    for (const Case& row : kOrthographics) {
        SCOPED_TRACE(row.name);
        const auto camera = [&](FrameView& v) {
            fromFarFlat(v);
            row.camera(v);
        };
        Drawn other = draw(row.name, {.depth = GL_DEPTH_COMPONENT32F, .upperLeft = row.upperLeft, .camera = camera});
        other.mirror(row.mirrorX, row.mirrorY);
        expectAlike(other, plain, 0.0015, 0.005);
    }
    const auto zeroToOne = [](bool reversed) {
        return [reversed](FrameView& v) {
            fromFarFlat(v);
            const float wide = kHalf * static_cast<float>(kWidth) / kHeight;
            v.projection =
                glm::orthoRH_ZO(-wide, wide, -kHalf, kHalf, reversed ? v.farPlane : v.nearPlane, reversed ? v.nearPlane : v.farPlane);
        };
    };
    for (const bool reversed : {false, true}) {
        SCOPED_TRACE(reversed ? "reversed" : "zero to one");
        expectAlike(draw(reversed ? "flat_reversed" : "flat_zero_to_one",
                         {.depth = GL_DEPTH_COMPONENT32F, .zeroToOne = true, .reversed = reversed, .camera = zeroToOne(reversed)}),
                    plain, 0.0015, 0.005);
    }
}

// Two worlds in one picture: each as if it were alone, where they do not cover each other.
TEST_F(WaterInAnyView, ShowsTwoWorlds) {
    std::array<std::unique_ptr<FluidWorld>, 2> worlds;
    for (size_t k = 0; k < 2; ++k) {
        FluidParams params = testing::hostWater();
        params.box = {vec3(k == 0 ? -0.1F : 0.65F, 0.0F, 0.2F), vec3(k == 0 ? 0.35F : 1.1F, 0.6F, 0.7F)};
        params.blocks = {{params.box.min, vec3(params.box.max.x, 0.3F, params.box.max.z), vec3(0.0F)}};
        auto world = FluidWorld::create(*device_, params, {}, {});
        ASSERT_TRUE(world) << world.error().message;
        worlds[k] = std::move(*world);
        worlds[k]->step({}, 1.0 / 60);
    }
    const auto picture = [&](bool first, bool second) {
        const HostScene host(kWidth, kHeight);
        const gpu::HostState scope;
        for (size_t k = 0; k < 2; ++k)
            if (k == 0 ? first : second) {
                const Status drawn = renderer_->draw(scope, host.view(), testing::viewOf(*worlds[k]), {}, host.target());
                EXPECT_TRUE(drawn) << drawn.error().message;
            }
        return host.pixels();
    };
    const std::vector<vec4> none = picture(false, false), left = picture(true, false), right = picture(false, true),
                            both = picture(true, true);
    size_t ofLeft = 0, ofRight = 0, shared = 0;
    for (size_t k = 0; k < none.size(); ++k) {
        const bool inLeft = left[k] != none[k], inRight = right[k] != none[k];
        ofLeft += inLeft ? 1 : 0;
        ofRight += inRight ? 1 : 0;
        shared += inLeft && inRight ? 1 : 0;
        if (inLeft && !inRight) EXPECT_EQ(both[k], left[k]);
        // The second reflects and refracts the first, as it does the rest of the picture.
        if (!inLeft && !inRight) EXPECT_EQ(both[k], none[k]);
    }
    EXPECT_GT(ofLeft, none.size() / 30);
    EXPECT_GT(ofRight, none.size() / 30);
    EXPECT_LT(shared, none.size() / 100);
}

// Without a depth buffer nothing hides the water: the picture is the one of a depth buffer that was cleared.
TEST_F(WaterInAnyView, NeedsNoDepthBuffer) {
    const HostScene with(kWidth, kHeight), without(kWidth, kHeight);
    glClearNamedFramebufferfv(with.target().framebuffer, GL_DEPTH, 0, std::array<float, 1>{1.0F}.data());
    glNamedFramebufferRenderbuffer(without.target().framebuffer, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER, 0);
    for (const HostScene* host : {&with, &without}) {
        const Status drawn = renderer_->draw(host->view(), testing::viewOf(*world_), {}, host->target());
        EXPECT_TRUE(drawn) << drawn.error().message;
    }
    EXPECT_EQ(with.pixels(), without.pixels());
}

// A target of another size, and the first size again.
TEST_F(WaterInAnyView, FollowsAResize) {
    const auto picture = [&](WaterRenderer& renderer, int width, int height) {
        const HostScene host(width, height);
        const Status drawn = renderer.draw(host.view(), testing::viewOf(*world_), {}, host.target());
        EXPECT_TRUE(drawn) << drawn.error().message;
        return host.pixels();
    };
    const std::vector<vec4> large = picture(*renderer_, kWidth, kHeight);
    for (const auto& [width, height] : {std::pair(64, 48), std::pair(1, 1), std::pair(333, 101)}) {
        auto fresh = WaterRenderer::create({});
        ASSERT_TRUE(fresh);
        EXPECT_EQ(picture(*renderer_, width, height), picture(**fresh, width, height)) << width << " x " << height;
    }
    EXPECT_EQ(picture(*renderer_, kWidth, kHeight), large);
}

// What cannot be drawn is refused in one sentence that names the remedy.
TEST_F(WaterInAnyView, IsRefusedWhereThereIsNoCamera) {
    const HostScene host(kWidth, kHeight);
    const FluidView fluid = testing::viewOf(*world_);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refusedFor = [&](const char* word, const std::function<void(FrameView&)>& spoil) {
        FrameView view = host.view();
        spoil(view);
        const Status drawn = renderer_->draw(view, fluid, {}, host.target());
        EXPECT_FALSE(drawn) << word;
        if (!drawn) EXPECT_NE(drawn.error().message.find(word), std::string::npos) << drawn.error().message;
    };
    refusedFor("not finite", [&](FrameView& v) { v.view[3].x = nan; });
    refusedFor("not finite", [&](FrameView& v) { v.projection[0][0] = nan; });
    refusedFor("use glm::lookAt", [&](FrameView& v) { v.view = mat4(0.0F); });
    refusedFor("singular", [&](FrameView& v) { v.view = v.view * scaled(1, 0, 1); });
    refusedFor("singular", [&](FrameView& v) { v.projection[0][0] = 0; });
    refusedFor("singular", [&](FrameView& v) { v.projection[3][2] = 0; });
    refusedFor("right angles", [&](FrameView& v) { v.projection[0][1] = 0.3F; });
    refusedFor("right angles", [&](FrameView& v) {
        fromFarFlat(v);
        v.projection[2][0] = 0.3F;  // a cabinet projection
    });
    refusedFor("neither", [&](FrameView& v) { v.projection[3][3] = 0.5F; });
    refusedFor("neither", [&](FrameView& v) { v.projection = mat4(0.0F); });
    refusedFor("units per metre", [&](FrameView& v) { v.unitsPerMetre = 0; });
    refusedFor("depth of the farthest object", [&](FrameView& v) { v.farPlane = std::numeric_limits<float>::infinity(); });
    refusedFor("move the eye back", [&](FrameView& v) {
        fromFarFlat(v);
        v.nearPlane = -1;
    });
}

}  // namespace
}  // namespace rivulet::any_view_test
