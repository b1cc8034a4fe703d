// Models as they are drawn: skin, eyes, what deforms, and a liquid on any material.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/gpu/device_gl.h"
#include "engine/render/skin_tables.h"
#include "engine/scene/import_model.h"
#include "fluid/scene/head_look.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_model_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;
const std::string kHead = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/head/";

class LookModel : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.background.showBox = false;
        settings.background.showFloor = false;
        settings.fluid.box = {.min = vec3(-0.05F), .max = vec3(0.05F)};
        settings.light.direction = vec3(-0.55F, 0.55F, 0.75F);
    }
    // A square in the plane z = 0, `size` m wide, whose uvs are 0..1.
    static ModelPart pane(float size, int cells = 1) {
        ModelPart part;
        part.name = "pane";
        for (int y = 0; y <= cells; ++y)
            for (int x = 0; x <= cells; ++x) {
                const vec2 uv(static_cast<float>(x) / static_cast<float>(cells), static_cast<float>(y) / static_cast<float>(cells));
                part.mesh.positions.emplace_back((uv.x - 0.5F) * size, (uv.y - 0.5F) * size, 0.0F);
                part.mesh.normals.emplace_back(0, 0, 1);
                part.mesh.uvs.push_back(uv);
            }
        const auto row = static_cast<uint32_t>(cells + 1);
        for (uint32_t y = 0; y + 1 < row; ++y)
            for (uint32_t x = 0; x + 1 < row; ++x) {
                const uint32_t a = y * row + x, b = a + 1, c = a + row, d = c + 1;
                part.mesh.indices.insert(part.mesh.indices.end(), {a, b, d, a, d, c});
            }
        return part;
    }
    static gpu::Texture wetMap(int size, const std::function<float(vec2)>& height, float unit) {
        std::vector<vec4> texels;
        const float e = 0.5F / static_cast<float>(size);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const vec2 uv((static_cast<float>(x) + 0.5F) / static_cast<float>(size),
                              (static_cast<float>(y) + 0.5F) / static_cast<float>(size));
                auto at = [&](float du, float dv) { return height((uv + vec2(du, dv) - 0.5F) * unit); };
                const float h = at(0, 0);
                texels.emplace_back((at(e, 0) - at(-e, 0)) / (2 * e), (at(0, e) - at(0, -e)) / (2 * e), 1000.0F * h, h > 0 ? 1.0F : 0.0F);
            }
        gpu::Texture map = std::move(*gpu::Texture::create({.width = size, .height = size, .format = gpu::Format::rgba16f, .mips = 0}));
        map.upload(std::as_bytes(std::span(texels)));
        map.generateMips();
        return map;
    }
    Node& addPart(const ModelPart& part) {
        Node node;
        node.name = part.name;
        node.mesh = std::make_shared<const Mesh>(part.mesh);
        node.material = part.material;
        return scene.nodes()[static_cast<size_t>(scene.add(std::move(node)))];
    }
    static Camera lookingAt(const vec3& from, const vec3& at, float fieldOfView) {
        Camera camera;
        camera.position = from;
        camera.target = at;
        camera.fieldOfView = fieldOfView;
        camera.nearPlane = 0.01F;
        camera.farPlane = 20.0F;
        return camera;
    }
    static int at(const std::vector<uint8_t>& rgba, int x, int y, int channel) {
        return rgba[(static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)) * 4 + static_cast<size_t>(channel)];
    }
};

TEST_F(LookModel, spreadLightIsNeitherLostNorMade) {
    Result<gpu::Texture> table = makeDiffusionTable();
    ASSERT_TRUE(table);
    const int cosines = table->width(), spreads = table->height();
    std::vector<float> texels(static_cast<size_t>(cosines) * static_cast<size_t>(spreads));
    table->read(std::as_writable_bytes(std::span(texels)));
    for (int y = 0; y < spreads; ++y) {
        // Over a ball each cosine is as frequent: what comes back in all is what fell on it, half of 1.
        double sum = 0;
        for (int x = 0; x < cosines; ++x) sum += texels[static_cast<size_t>(y) * static_cast<size_t>(cosines) + static_cast<size_t>(x)];
        EXPECT_NEAR(2 * sum / cosines, 0.5, 0.01) << "spread " << y;
    }
    for (int x = 0; x < cosines; ++x)
        EXPECT_NEAR(texels[static_cast<size_t>(x)], std::max(2.0 * (x + 0.5) / cosines - 1.0, 0.0), 0.02) << "not spread at all: Lambert";
}

TEST_F(LookModel, aFlatLiquidRefractsBySnellsLaw) {
    // A black and white edge under 2 mm of water, seen at 45 degrees: it moves by h (tan 45 - tan of the bent angle).
    constexpr float kSize = 0.04F, kDepth = 2.0e-3F;
    ModelPart part = pane(kSize);
    auto edge = std::make_shared<Image>(Image{"edge", 512, 512, std::vector<uint8_t>(size_t{4} * 512 * 512, 255)});
    for (size_t i = 0; i < size_t{512} * 512; ++i)
        if (i / 512 < 256) edge->rgba[4 * i] = edge->rgba[4 * i + 1] = edge->rgba[4 * i + 2] = 0;  // black below
    part.material.colour = edge;
    part.material.roughness = 1.0F;
    const gpu::Texture map = wetMap(
        64, [](vec2) { return kDepth; }, kSize);
    Node& node = addPart(part);
    const float away = 0.1F, field = 4.0F;
    Camera camera = lookingAt(vec3(0, -away, away) / std::sqrt(2.0F), vec3(0.0F), field);
    auto edgeRow = [&](const std::vector<uint8_t>& rgba) {
        for (int y = 0; y + 1 < kHeight; ++y)
            if (at(rgba, kWidth / 2, y, 1) - at(rgba, kWidth / 2, y + 1, 1) > 40) return y;
        return -1;
    };
    const int dry = edgeRow(picture(camera, kWidth, kHeight, {}));
    auto layer = std::make_shared<Layer>();
    layer->texels = &map;
    layer->look.absorption = vec3(0.0F);
    node.layer = layer;
    const int wet = edgeRow(picture(camera, kWidth, kHeight, {}));
    ASSERT_GE(dry, 0);
    ASSERT_GE(wet, 0);
    const float sine = std::sin(kPi / 4) / layer->look.refractiveIndex, bent = sine / std::sqrt(1 - sine * sine);
    const float shift = kDepth * (1.0F - bent);                                                           // m, along the pane
    const float pixel = 2.0F * away * std::tan(0.5F * field * kPi / 180.0F) / kHeight * std::sqrt(2.0F);  // m of the pane
    EXPECT_NEAR(static_cast<float>(dry - wet), shift / pixel, 1.5F) << "the bottom looks nearer, its edge farther up";
    scene = Scene();
}

TEST_F(LookModel, aDryLayerChangesNothingAndADropOnlyWhereItIs) {
    constexpr float kSize = 0.04F, kRadius = 2.0e-3F, kHeightOf = 0.7e-3F;
    for (const float metal : {0.0F, 1.0F})
        for (const int cells : {1, 40}) {
            scene = Scene();
            ModelPart part = pane(kSize, cells);
            part.material.metallic = metal;
            part.material.roughness = 0.5F;
            const gpu::Texture none = wetMap(
                256, [](vec2) { return 0.0F; }, kSize);
            const gpu::Texture drop = wetMap(
                256, [](vec2 x) { return std::max(kHeightOf * (1.0F - glm::dot(x, x) / (kRadius * kRadius)), 0.0F); }, kSize);
            Node& node = addPart(part);
            const Camera camera = lookingAt(vec3(0, 0, 0.06F), vec3(0.0F), 16.0F);
            auto layer = std::make_shared<Layer>();
            layer->texels = &none;
            node.layer = layer;
            const std::vector<uint8_t> dry = picture(camera, kWidth, kHeight, {});
            auto wetLayer = std::make_shared<Layer>();
            wetLayer->texels = &drop;
            node.layer = wetLayer;
            const std::vector<uint8_t> wet = picture(camera, kWidth, kHeight, {});
            node.layer = nullptr;
            node.material.doubleSided = false;  // still drawn as a part
            EXPECT_EQ(dry, picture(camera, kWidth, kHeight, {}));
            const float pixel = 2.0F * 0.06F * std::tan(8.0F * kPi / 180.0F) / kHeight;
            int inside = 0, outside = 0;
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x) {
                    int differs = 0;
                    for (int c = 0; c < 3; ++c) differs = std::max(differs, std::abs(at(wet, x, y, c) - at(dry, x, y, c)));
                    const float r = pixel * glm::length(vec2(x - 0.5F * kWidth, y - 0.5F * kHeight));
                    if (differs > 4) ++(r < kRadius * 1.6F ? inside : outside);  // a small shadow falls beside it
                }
            EXPECT_EQ(outside, 0) << metal << " " << cells;
            EXPECT_GT(inside, 0.4F * kPi * kRadius * kRadius / (pixel * pixel)) << metal << " " << cells;
        }
    scene = Scene();
}

TEST_F(LookModel, aWetWayShinesOnTheSideThatLeansToTheLamp) {
    // A stripe of film 2 mm wide that is flat in its map: drawn as a cushion, one side mirrors a lamp to the right, the other one to the
    // left.
    constexpr float kSize = 0.016F;
    ModelPart part = pane(kSize, 40);
    part.material.baseColour = vec3(0.02F);
    const gpu::Texture stripe = wetMap(
        64, [](vec2 x) { return std::abs(x.x) < 1.0e-3F ? 1.0e-5F : 0.0F; }, kSize);
    Node& node = addPart(part);
    auto layer = std::make_shared<Layer>();
    layer->texels = &stripe;
    node.layer = layer;
    const Camera camera = lookingAt(vec3(0, 0, 0.1F), vec3(0.0F), 6.0F);
    const float pixel = 2.0F * 0.1F * std::tan(3.0F * kPi / 180.0F) / kHeight;
    double sides[2][2];  // of a lamp to the left, to the right: the mean of the stripe's left and right half
    for (const int to : {0, 1}) {
        settings.light.direction = vec3(to == 0 ? -0.2F : 0.2F, 0.0F, 1.0F);
        const std::vector<uint8_t> rgba = picture(camera, kWidth, kHeight, {});
        for (const int side : {0, 1}) {
            double sum = 0, count = 0;
            for (int y = kHeight / 4; y < 3 * kHeight / 4; ++y)
                for (int x = 0; x < kWidth; ++x) {
                    const float off = pixel * (static_cast<float>(x) + 0.5F - 0.5F * kWidth) * (side == 0 ? -1.0F : 1.0F);
                    if (off < 1.0e-4F || off > 0.9e-3F) continue;
                    sum += at(rgba, x, y, 1);
                    ++count;
                }
            sides[to][side] = sum / count;
        }
    }
    EXPECT_GT(sides[0][0], 1.3 * sides[0][1]);
    EXPECT_GT(sides[1][1], 1.3 * sides[1][0]);
    EXPECT_NEAR(sides[0][0] / sides[1][1], 1, 0.1) << "its two sides are alike";
    scene = Scene();
}

TEST_F(LookModel, aDropOnAPaneInvertsTheBackground) {
    constexpr float kSize = 0.04F, kRadius = 2.0e-3F;
    for (const bool upper : {true, false}) {  // red above, green below
        ModelPart wall = pane(0.2F);
        for (vec3& p : wall.mesh.positions) p += vec3(0.0F, upper ? 0.1F : -0.1F, -0.1F);
        wall.material.baseColour = upper ? vec3(0.8F, 0.05F, 0.05F) : vec3(0.05F, 0.8F, 0.05F);
        wall.material.roughness = 1.0F;
        addPart(wall);
    }
    ModelPart glass = pane(kSize);
    glass.material.blended = true;
    glass.material.opacity = 0.0F;
    glass.material.roughness = 0.1F;
    const gpu::Texture drop = wetMap(
        512, [](vec2 x) { return std::max(1.0e-3F * (1.0F - glm::dot(x, x) / (kRadius * kRadius)), 0.0F); }, kSize);
    Node& node = addPart(glass);
    auto layer = std::make_shared<Layer>();
    layer->texels = &drop;
    const Camera camera = lookingAt(vec3(0, 0, 0.1F), vec3(0.0F), 16.0F);
    auto redder = [&](const std::vector<uint8_t>& rgba, float y) {  // m above the drop's middle
        const float pixel = 2.0F * 0.1F * std::tan(8.0F * kPi / 180.0F) / kHeight;
        const int row = kHeight / 2 - static_cast<int>(y / pixel);
        return at(rgba, kWidth / 2, row, 0) - at(rgba, kWidth / 2, row, 1);
    };
    const std::vector<uint8_t> dry = picture(camera, kWidth, kHeight, {});
    node.layer = layer;
    const std::vector<uint8_t> wet = picture(camera, kWidth, kHeight, {});
    const float inside = 0.6F * kRadius, outside = 2.0F * kRadius;
    EXPECT_GT(redder(dry, inside), 40);
    EXPECT_LT(redder(dry, -inside), -40);
    EXPECT_LT(redder(wet, inside), -40);
    EXPECT_GT(redder(wet, -inside), 40);
    EXPECT_NEAR(redder(wet, outside), redder(dry, outside), 3);
    EXPECT_NEAR(redder(wet, -outside), redder(dry, -outside), 3);
    scene = Scene();
}

HdrImage surroundings(const std::function<float(vec3)>& light) {
    HdrImage image{"test", 128, 64, {}};
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const float up = (static_cast<float>(y) + 0.5F) / 64 * kPi - 0.5F * kPi,
                        turn = ((static_cast<float>(x) + 0.5F) / 128 - 0.5F) * 2 * kPi;
            image.texels.emplace_back(light(vec3(std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn))));
        }
    return image;
}

TEST_F(LookModel, aMatteSurfaceGetsTheCosinesShareOfItsSurroundings) {
    // A cosine leaves 1 of a constant, 2/3 of a gradient, 1/4 of a second order.
    const std::array<vec4, 9> even = matteLight(surroundings([](vec3) { return 0.7F; }));
    EXPECT_NEAR(even[0].x, 0.7F, 1e-3F);
    for (size_t k = 1; k < 9; ++k) EXPECT_NEAR(even[k].y, 0.0F, 1e-3F) << k;
    const std::array<vec4, 9> slope = matteLight(surroundings([](vec3 d) { return 1.0F + 0.5F * d.y - 0.3F * d.x + 0.2F * d.z; }));
    EXPECT_NEAR(slope[1].x, 0.5F * 2 / 3, 1e-3F);
    EXPECT_NEAR(slope[3].x, -0.3F * 2 / 3, 1e-3F);
    EXPECT_NEAR(slope[2].x, 0.2F * 2 / 3, 1e-3F);
    const std::array<vec4, 9> saddle =
        matteLight(surroundings([](vec3 d) { return 1.0F + 0.4F * d.x * d.y + 0.3F * (d.x * d.x - d.y * d.y); }));
    EXPECT_NEAR(saddle[4].x, 0.4F / 4, 1e-3F);
    EXPECT_NEAR(saddle[8].x, 0.3F / 4, 1e-3F);
}

TEST_F(LookModel, surroundingsAreSeenAndMirroredWhereTheyAre) {
    // Bright at +x, dark at -x: so is the sky to the right, and a mirror that faces right.
    const HdrImage image = surroundings([](vec3 d) { return d.x > 0 ? 0.9F : 0.05F; });
    Result<std::unique_ptr<SceneRenderer>> made = SceneRenderer::create(ShaderFiles::developer(), &image);
    ASSERT_TRUE(made) << made.error().message;
    settings.light.intensity = 0.0F;
    auto shot = [&](const Camera& camera) {
        const Status drawn = (*made)->draw(frameViewOf(camera, settings.light, kWidth, kHeight, 0), {}, scene, settings);
        EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message);
        return (*made)->pixels();
    };
    const std::vector<uint8_t> sky = shot(lookingAt(vec3(0, 0, 1), vec3(0.0F), 40.0F));
    EXPECT_GT(at(sky, kWidth * 3 / 4, kHeight / 2, 1), at(sky, kWidth / 4, kHeight / 2, 1) + 80);
    ModelPart mirror = pane(4.0F);
    mirror.material.metallic = 1.0F;
    mirror.material.roughness = 0.05F;
    mirror.material.baseColour = vec3(1.0F);
    addPart(mirror);
    const std::vector<uint8_t> left = shot(lookingAt(vec3(-0.5F, 0, 0.5F), vec3(0.0F), 10.0F));  // sees what is at the right
    const std::vector<uint8_t> right = shot(lookingAt(vec3(0.5F, 0, 0.5F), vec3(0.0F), 10.0F));
    EXPECT_GT(at(left, kWidth / 2, kHeight / 2, 1), at(right, kWidth / 2, kHeight / 2, 1) + 80);
    scene = Scene();
}

TEST_F(LookModel, redBleedsFurthestIntoShade) {
    // A ball of 1 cm of the same grey, as skin and not: at the terminator skin is redder than where the light falls straight.
    ModelPart ball;
    for (int k = 0; k <= 32; ++k)
        for (int i = 0; i <= 64; ++i) {
            const float t = kPi * static_cast<float>(k) / 32, f = 2 * kPi * static_cast<float>(i) / 64;
            const vec3 n(std::sin(t) * std::cos(f), std::cos(t), -std::sin(t) * std::sin(f));
            ball.mesh.positions.push_back(0.01F * n);
            ball.mesh.normals.push_back(n);
            ball.mesh.uvs.emplace_back(static_cast<float>(i) / 64, static_cast<float>(k) / 32);
        }
    for (uint32_t k = 0; k < 32; ++k)
        for (uint32_t i = 0; i < 64; ++i) {
            const uint32_t a = k * 65 + i, b = a + 1, c = a + 65, d = c + 1;
            ball.mesh.indices.insert(ball.mesh.indices.end(), {a, c, d, a, d, b});
        }
    ball.material.baseColour = vec3(0.5F);
    ball.material.roughness = 1.0F;
    settings.light.direction = vec3(1, 0, 0.05F);
    settings.background.horizon = settings.background.zenith = vec3(0.02F);
    const Camera camera = lookingAt(vec3(0, 0, 0.1F), vec3(0.0F), 16.0F);
    auto redness = [&](const std::vector<uint8_t>& rgba, int x) { return at(rgba, x, kHeight / 2, 0) - at(rgba, x, kHeight / 2, 2); };
    Node& node = addPart(ball);
    auto skin = std::make_shared<SkinLook>();
    skin->pores = 0;
    node.material.skin = skin;
    const std::vector<uint8_t> flesh = picture(camera, kWidth, kHeight, {});
    node.material.skin = nullptr;
    const std::vector<uint8_t> stone = picture(camera, kWidth, kHeight, {});
    EXPECT_GT(redness(flesh, kWidth / 2), 12);
    EXPECT_LT(std::abs(redness(stone, kWidth / 2)), 6);
    EXPECT_LT(std::abs(redness(flesh, kWidth / 2 + 40)), 10);
    scene = Scene();
}

TEST_F(LookModel, whatDeformsIsDrawnWhereItIsFromAnyDeviceAndItsShadowFollows) {
    ModelPart wall = pane(0.3F), lid = pane(0.06F, 4);
    for (vec3& p : lid.mesh.positions) p.z = 0.05F;
    MorphTarget aside{"aside", {}, {}};
    for (uint32_t v = 0; v < lid.mesh.positions.size(); ++v) aside.vertices.push_back(v), aside.offsets.emplace_back(0.08F, 0.0F, 0.0F);
    lid.morphs = {aside};
    settings.light.direction = vec3(0, 0, 1);
    const Camera camera = lookingAt(vec3(0, 0.3F, 0.4F), vec3(0.0F), 30.0F);
    const std::vector<CpuKernelRow> rows = cpuKernels();
    std::unique_ptr<Device> cpu = makeCpuDevice(rows), gl = makeGlDevice(ShaderFiles::developer());
    std::vector<std::vector<uint8_t>> pictures;
    for (Device* device : {cpu.get(), gl.get()}) {
        scene = Scene();
        addPart(wall);
        Result<Deformer> made = Deformer::create(*device, lid);
        ASSERT_TRUE(made) << made.error().message;
        auto deformer = std::make_shared<Deformer>(std::move(*made));
        addPart(lid).deformer = deformer;
        for (const float weight : {0.0F, 1.0F, 0.0F}) {
            deformer->run(std::vector<float>{weight});
            pictures.push_back(picture(camera, kWidth, kHeight, {}));
        }
        scene = Scene();
    }
    EXPECT_EQ(pictures[0], pictures[2]) << "not back where it was";
    EXPECT_LT(meanAbsoluteError(pictures[0], pictures[3]), 0.02);
    EXPECT_LT(meanAbsoluteError(pictures[1], pictures[4]), 0.02);
    // The shadow on the wall, straight behind the lid: dark where the lid was over it, lit where it has gone from.
    const mat4 toClip = camera.projection(static_cast<float>(kWidth) / kHeight) * camera.view();
    auto seen = [&](const std::vector<uint8_t>& rgba, const vec3& p) {
        const vec4 clip = toClip * vec4(p, 1.0F);
        return at(rgba, static_cast<int>((clip.x / clip.w * 0.5F + 0.5F) * kWidth),
                  static_cast<int>((0.5F - clip.y / clip.w * 0.5F) * kHeight), 1);
    };
    const vec3 first(0.0F, 0.02F, 0.0F), second(0.08F, 0.02F, 0.0F);
    EXPECT_GT(seen(pictures[1], first), seen(pictures[0], first) + 20);
    EXPECT_LT(seen(pictures[1], second), seen(pictures[0], second) - 20);
}

TEST_F(LookModel, goldenHead) {
    Result<Model> head = importModel(kHead + "head.glb");
    ASSERT_TRUE(head) << head.error().message;
    const Status dressed = dressHead(*head, kHead);
    ASSERT_TRUE(dressed) << dressed.error().message;
    // A drop of 4 mm and a film around it on the right cheek, over the skin's uvs.
    const gpu::Texture map = wetMap(
        1024,
        [](vec2 x) {
            const vec2 d = x - vec2(-0.045F, 0.0F);
            return std::max({1.2e-3F * (1.0F - glm::dot(d, d) / (0.006F * 0.006F)), glm::length(d) < 0.02F ? 2e-5F : 0.0F, 0.0F});
        },
        0.36F);
    auto layer = std::make_shared<Layer>();
    layer->texels = &map;
    std::unique_ptr<Device> cpu = makeCpuDevice(cpuKernels());
    const std::vector<mat4> world = head->worldMatrices();
    for (const ModelPart& part : head->parts) {
        Node& node = addPart(part);
        node.local = world[static_cast<size_t>(part.node)];
        if (part.name == "skin") node.layer = layer;
        if (part.morphs.empty()) continue;
        Result<Deformer> made = Deformer::create(*cpu, part);
        ASSERT_TRUE(made) << made.error().message;
        made->run(std::vector<float>{0.0F, 0.3F, 0.6F});
        node.deformer = std::make_shared<Deformer>(std::move(*made));
    }
    const Camera camera = lookingAt(vec3(-0.25F, 0.02F, 0.42F), vec3(-0.01F, 0.0F, 0.0F), 22.0F);
    compareWith("head", kWidth, kHeight, picture(camera, kWidth, kHeight, {}));
    scene = Scene();
}

}  // namespace
}  // namespace rivulet::look_model_test
