// Pictures of bodies that the GPU moves: they show its own poses, also after a blow, which the host learns of some frames late.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "engine/gpu/device_gl.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/scene/collider_motion.h"
#include "fluid/session/replay.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::body_pictures_test {
namespace {

// A light duck, a body of three meshes, falls 0.5 m into a pool. The light's frustum, which encloses what is drawn, does not depend on it.
std::string duckFalls() {
    const std::string path = ::testing::TempDir() + "body_pictures_duck_falls.json";
    std::ofstream(path) << R"({"name": "duck_falls", "doc": "", "fluid": {"method": "pbf", "spacing": 0.08,
        "box": {"max": [1.2, 1.6, 1.2]}, "blocks": [{"max": [1.2, 0.42, 1.2]}]},
        "bodies": [{"shape": "mesh", "mesh": "meshes/duck.obj", "fitSize": 0.3, "density": 120, "position": [0.6, 1.1, 0.6],
            "rotation": [20, 40, 10], "spin": [90, 0, 60], "porosity": 1, "roughness": 0.6,
            "parts": [{"mesh": "meshes/duck_beak.obj"}, {"mesh": "meshes/duck_eyes.obj"}]}],
        "colliders": [{"mesh": "meshes/duck.obj", "position": [0, 0, 0], "fitSize": 0.02, "solid": false},
            {"mesh": "meshes/duck.obj", "position": [1.2, 1.6, 1.2], "fitSize": 0.02, "solid": false}],
        "camera": {"position": [1.5, 1.1, 1.9], "target": [0.6, 0.6, 0.6], "fieldOfView": 40}})";
    return path;
}

struct Difference {
    int most = 0;       // of 255
    size_t pixels = 0;  // that differ by more than 8
};
Difference between(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    Difference d;
    for (size_t k = 0; k + 3 < a.size(); k += 4) {
        int most = 0;
        for (size_t c = k; c < k + 3; ++c) most = std::max(most, std::abs(int{a[c]} - int{b[c]}));
        d.most = std::max(d.most, most);
        d.pixels += most > 8 ? 1 : 0;
    }
    return d;
}

class BodyPictures : public testing::OpenGlTest {};

// The same frame is drawn three times: as the window does; where the duck was expected, since the picture has no poses; and after a wait,
// with the poses that were read back. The first and the last are equal, with all that follows from the place of a mesh: depth, shadow,
// light in the water, where it is wet.
TEST_F(BodyPictures, ABlowIsDrawnWhereTheGpuHasTheBody) {
    const ShaderFiles files = ShaderFiles::developer();
    for (const bool wet : {false, true}) {
        SCOPED_TRACE(wet);
        const Result<SceneFile> scene =
            loadScene(duckFalls(), std::vector<std::string>{std::string("fluid.wetness.on=") + (wet ? "true" : "false")});
        ASSERT_TRUE(scene) << scene.error().message;
        const std::unique_ptr<Device> device = makeGlDevice(files, {});
        const auto made = Session::create(*scene, *device, {});
        ASSERT_TRUE(made) << made.error().message;
        Session& session = **made;
        const auto renderer = SceneRenderer::create(files);
        ASSERT_TRUE(renderer) << renderer.error().message;
        FluidUpload upload;
        const FrameView view = frameViewOf(cameraOf(scene->camera, session.bounds()), scene->light, 128, 96, 0);
        const auto picture = [&](const FluidView& fluid, const Scene& solids) {
            const Status drawn = (*renderer)->draw(view, fluid, solids, session.scene());
            EXPECT_TRUE(drawn) << drawn.error().message;
            return (*renderer)->pixels();
        };
        size_t seen = 0, most = 0;
        int moved = 0;
        for (int frame = 0; frame < 25; ++frame) {
            session.step(1.0 / 60, false);
            if (frame < 19) continue;  // it falls
            const uint64_t waits = session.world().stats().bodyWaits;
            Result<FluidView> fluid = viewOf(upload, session);
            ASSERT_TRUE(fluid) << fluid.error().message;
            if (!fluid->bodiesMoved) continue;
            ++moved;
            const std::vector<uint8_t> shown = picture(*fluid, session.solids());
            EXPECT_EQ(session.world().stats().bodyWaits, waits) << "a picture waits for nothing";
            if (frame % 2 == 0)
                fluid->bodiesMoved = nullptr;
            else
                fluid->bodies = 0;
            const std::vector<uint8_t> expected = picture(*fluid, session.solids());
            Scene there = session.solids();
            const std::vector<BodyState>& states = session.world().bodies();
            for (size_t n = 0; n < there.nodes().size(); ++n)
                if (there.nodes()[n].body == 0) there.moveBody(n, matrixOf(states[0].pose));
            const Difference d = between(shown, picture(*fluid, there));
            EXPECT_LE(d.most, 2) << frame;
            EXPECT_EQ(d.pixels, 0U) << frame;
            const size_t off = between(shown, expected).pixels;
            most = std::max(most, off);
            seen += off > 20 ? 1 : 0;
        }
        std::printf("%d frames moved by the GPU, %zu of them differ from where the duck was expected, by up to %zu pixels\n", moved, seen,
                    most);
        EXPECT_EQ(moved, 6);
        EXPECT_GT(seen, 0U) << "else this tested nothing";
    }
}

}  // namespace
}  // namespace rivulet::body_pictures_test
