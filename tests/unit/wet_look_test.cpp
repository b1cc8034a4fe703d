// The look of wet meshes: porous ones are darker, plastic hardly, half wet ones on one half; and dry ones look as if nothing could be wet.
#include "engine/gpu/buffer.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/sim/solids/wet_surface.h"
#include "tests/physics/baked_mesh.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::wet_look_test {
namespace {

constexpr int kWide = 96, kHigh = 96;
using WetLook = GpuTest;

// The mean green of the left and the right half of a box that fills the picture.
struct Halves {
    double left = 0, right = 0;
};

// `wetness` of a point of the surface; nothing: the mesh has no wetness.
Halves drawn(SceneRenderer& renderer, float porosity, bool part, const std::function<float(const vec3&)>& wetness) {
    const test::Mesh box = test::makeBox(vec3(-0.5F), vec3(0.5F));
    const VoxelField field = test::baked(box, 0.02F, 0.05F);
    const WetSurface surface = WetSurface::of({.field = &field}, 0.05F);
    Mesh mesh;
    mesh.positions = box.positions;
    mesh.indices = box.indices;
    recomputeNormals(mesh);
    Node node;
    node.mesh = std::make_shared<const Mesh>(std::move(mesh));
    node.material.porosity = porosity;
    node.material.doubleSided = !part;  // one side alone needs the full program
    FluidView fluid;
    gpu::Buffer cells, values;
    if (wetness) {
        std::vector<float> wet;
        for (const WetSurface::Point& p : surface.points) wet.push_back(wetness(vec3(p.place)));
        cells = std::move(*gpu::Buffer::from(surface.cells));
        values = std::move(*gpu::Buffer::from(wet));
        fluid.wetCells = cells.name();
        fluid.wetCellBytes = cells.bytes();
        fluid.wetness = values.name();
        fluid.wetnessBytes = values.bytes();
        const WetSolid& solid = surface.solids[0];
        node.wet = WetGrid{solid.cellsFromWorld(mat4(1.0F)), solid.size, solid.firstCell};
    }
    Scene scene;
    scene.add(std::move(node));
    SceneFile settings;
    settings.background.showFloor = settings.background.showBox = false;
    settings.camera.position = vec3(0, 0, 1.5F);
    settings.camera.target = vec3(0.0F);
    settings.camera.fieldOfView = 30;
    settings.light.direction = vec3(0.7F, 0.5F, 0.6F);  // its mirror image is not in the picture
    const Camera camera = cameraOf(settings.camera, scene.bounds());
    const Status done = renderer.draw(frameViewOf(camera, settings.light, kWide, kHigh, 0), fluid, scene, settings);
    EXPECT_TRUE(done) << done.error().message;
    const std::vector<uint8_t> pixels = renderer.pixels();
    Halves h;
    for (int y = 8; y < kHigh - 8; ++y)
        for (int x = 8; x < kWide - 8; ++x)
            (x < kWide / 2 ? h.left : h.right) += double{static_cast<double>(pixels[static_cast<size_t>(4 * (y * kWide + x) + 1)])};
    const double count = (kHigh - 16) * (kWide / 2 - 8);
    return {h.left / count, h.right / count};
}

TEST_F(WetLook, PorousMeshesAreDarkerWhereTheyAreWet) {
    Result<std::unique_ptr<SceneRenderer>> renderer = SceneRenderer::create(ShaderFiles::developer());
    ASSERT_TRUE(renderer) << renderer.error().message;
    for (const bool part : {false, true}) {
        const auto draw = [&](float porosity, const std::function<float(const vec3&)>& wetness) {
            return drawn(**renderer, porosity, part, wetness);
        };
        const Halves plain = draw(1, {}), dry = draw(1, [](const vec3&) { return 0.0F; }), wet = draw(1, [](const vec3&) { return 1.0F; }),
                     plastic = draw(0, [](const vec3&) { return 1.0F; }),
                     half = draw(1, [](const vec3&p) { return p.x < 0 ? 1.0F : 0.0F; });
        EXPECT_NEAR(dry.left, plain.left, 1.5);
        EXPECT_NEAR(dry.right, plain.right, 1.5);
        EXPECT_LT(wet.left, plain.left - 20);
        EXPECT_LT(wet.right, plain.right - 20);
        EXPECT_GT(plastic.left, wet.left + 15);
        EXPECT_NEAR(half.left, wet.left, 5);
        EXPECT_NEAR(half.right, dry.right, 5);
    }
}

}  // namespace
}  // namespace rivulet::wet_look_test
