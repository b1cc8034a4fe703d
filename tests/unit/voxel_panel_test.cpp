// The voxel panel, driven by InputEvents and drawn into a framebuffer: it shows the content of the field.
#include "fluid/viewer/voxel_panel.h"

#include <gtest/gtest.h>
#include <imgui.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "engine/app/capture.h"
#include "engine/app/ui_layer.h"
#include "fluid/voxel/voxel_picture.h"
#include "tests/unit/framebuffer_fixture.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_panel_test {
namespace {

class VoxelPanelTest : public testing::FramebufferFixture {
  protected:
    void SetUp() override {
        open(kWindow, kWindow);
        ASSERT_TRUE(context_ && target_.name() != 0);
        auto ui = UiLayer::create();
        ASSERT_TRUE(ui) << ui.error().message;
        ui_.emplace(std::move(*ui));
        input_.mouse = vec2(-100);
        // A ball in a box: between them is one material, in the ball another.
        const test::Mesh box = test::makeBox(vec3(0), vec3(1)), ball = test::makeSphere(vec3(0.5F), 0.25F);
        const MeshView views[] = {box.view(), ball.view()};
        Result<VoxelField> field = bakeVoxelField(views, {.resolution = 32});
        ASSERT_TRUE(field) << field.error().message;
        field_ = std::move(*field);
    }
    void TearDown() override {
        panel_.emplace();  // its texture goes before the context
        panel_.reset();
        ui_.reset();
        FramebufferFixture::TearDown();
    }

    void frame(const VoxelField* field, bool shown) {
        ui_->begin(input_, 1.0 / 60);
        ImGui::SetNextWindowPos(ImVec2(10, 10));
        ImGui::SetNextWindowSize(ImVec2(320, 760));
        ImGui::Begin("test");
        if (shown) panel_->draw({.still = field, .rigid = rigid_, .deforming = deforming_}, time_, ImGui::GetContentRegionAvail().x);
        ImGui::End();
        glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
        glViewport(0, 0, kWindow.x, kWindow.y);
        glClearColor(0.4F, 0.4F, 0.4F, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        ui_->draw();
        endFrame();
    }
    void click(vec2 place) {
        input_.mouse = place;
        frame(&field_, true);
        input_.buttonPressed[0] = input_.buttonDown[0] = true;
        frame(&field_, true);
        input_.buttonDown[0] = false;
        input_.buttonReleased[0] = true;
        frame(&field_, true);
        input_.mouse = vec2(-100);
        frame(&field_, true);
        frame(&field_, true);
    }
    std::vector<uint8_t> pixels() const {
        std::vector<uint8_t> flipped(picture_.hostBytes()), texels(flipped.size());
        picture_.read(std::as_writable_bytes(std::span(flipped)));
        const size_t row = 4 * static_cast<size_t>(kWindow.x);
        for (size_t y = 0; y < static_cast<size_t>(kWindow.y); ++y)
            std::copy_n(flipped.begin() + static_cast<std::ptrdiff_t>((static_cast<size_t>(kWindow.y) - 1 - y) * row), row,
                        texels.begin() + static_cast<std::ptrdiff_t>(y * row));
        return texels;
    }
    // How many pixels have exactly this colour.
    size_t count(const vec3& linear) const {
        const std::vector<uint8_t> texels = pixels();
        const uint32_t bytes = srgbBytes(linear);
        size_t n = 0;
        for (size_t k = 0; k < texels.size(); k += 4)
            n += texels[k] == (bytes & 255U) && texels[k + 1] == ((bytes >> 8U) & 255U) && texels[k + 2] == ((bytes >> 16U) & 255U) ? 1 : 0;
        return n;
    }

    static constexpr ivec2 kWindow{340, 780};
    std::optional<UiLayer> ui_;
    std::optional<VoxelPanel> panel_{std::in_place};
    VoxelField field_;
    std::vector<const VoxelField*> rigid_, deforming_;
    double time_ = 0;
};

TEST_F(VoxelPanelTest, ShowsTheMiddleSlice) {
    frame(&field_, false);
    frame(&field_, false);
    EXPECT_EQ(count(materialColour(0)), 0U);
    for (int k = 0; k < 3; ++k) frame(&field_, true);
    if (const char* to = std::getenv("RIVULET_TEST_PICTURES"))  // for inspection
        ASSERT_TRUE(writePng(std::string(to) + "/voxel_panel.png", pixels(), kWindow.x, kWindow.y));

    // The middle slice of the grid, counted voxel by voxel; each voxel has the same number of pixels.
    const VoxelLabels labels = labelRegions(field_.surface, nullptr);
    ASSERT_EQ(labels.materials.size(), 2U);
    const ivec3& size = field_.surface.size;
    size_t voxels[4] = {};
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) ++voxels[labels.at({x, y, size.z / 2})];
    const double pixelsPerVoxel = std::pow(300.0 / std::max(size.x, size.y), 2);
    for (uint32_t label = kFirstMaterial; label < 4; ++label) {
        const auto expected = pixelsPerVoxel * static_cast<double>(voxels[label]);
        EXPECT_NEAR(static_cast<double>(count(labelColour(labels, label))), expected, 0.06 * expected + 200) << label;
    }

    const size_t before = count(materialColour(0));
    frame(nullptr, true);
    EXPECT_EQ(count(materialColour(0)), 0U) << "no field, no picture";
    panel_->clear();
    frame(&field_, true);
    frame(&field_, true);
    EXPECT_EQ(count(materialColour(0)), before);
}

TEST_F(VoxelPanelTest, AxisSliceAndDistanceMayBeChosen) {
    for (int k = 0; k < 3; ++k) frame(&field_, true);
    const std::vector<uint8_t> first = pixels();
    const size_t material = count(materialColour(1));
    EXPECT_GT(material, 1000U);
    // The slider's left end: the first slice holds no ball.
    bool moved = false, distance = false;
    for (float y = 90; y < 220 && !(moved && distance); y += 8) {
        click(vec2(24, y));
        moved = moved || count(materialColour(1)) < 400;
        click(vec2(255, y));
        distance = distance || count(materialColour(0)) < 400;
    }
    EXPECT_TRUE(moved) << "the slider moves the slice";
    EXPECT_TRUE(distance) << "the band hides the materials, except in the list";
    EXPECT_NE(first, pixels());
    if (const char* to = std::getenv("RIVULET_TEST_PICTURES"))
        ASSERT_TRUE(writePng(std::string(to) + "/voxel_panel_distance.png", pixels(), kWindow.x, kWindow.y));
}

// A deforming mesh is shown in its present state, but not labelled again for each picture.
TEST_F(VoxelPanelTest, ADeformingFieldIsUpdated) {
    const test::Mesh box = test::makeBox(vec3(0), vec3(1)), ball = test::makeSphere(vec3(0.5F), 0.25F);
    const MeshView hollow[] = {box.view()}, both[] = {box.view(), ball.view()};
    Result<VoxelField> bending = bakeVoxelField(hollow, {.resolution = 32}), later = bakeVoxelField(both, {.resolution = 32});
    ASSERT_TRUE(bending && later);
    deforming_ = {&*bending};
    for (int k = 0; k < 3; ++k) frame(nullptr, true);
    EXPECT_GT(count(materialColour(0)), 1000U);
    EXPECT_LT(count(materialColour(1)), 100U);
    *bending = *later;
    for (int k = 0; k < 40; ++k) frame(nullptr, true);
    EXPECT_LT(count(materialColour(1)), 100U) << "no time has passed";
    time_ += 0.1;
    for (int k = 0; k < 600 && count(materialColour(1)) < 1000; ++k) frame(nullptr, true);
    EXPECT_GT(count(materialColour(1)), 1000U);
}

TEST_F(VoxelPanelTest, OneOfSeveralFieldsMayBeChosen) {
    const test::Mesh box = test::makeBox(vec3(0), vec3(1));
    const MeshView hollow[] = {box.view()};
    Result<VoxelField> moving = bakeVoxelField(hollow, {.resolution = 32});
    ASSERT_TRUE(moving) << moving.error().message;
    rigid_ = {&*moving};
    for (int k = 0; k < 3; ++k) frame(&field_, true);
    EXPECT_GT(count(materialColour(1)), 1000U) << "the static field comes first";
    if (const char* to = std::getenv("RIVULET_TEST_PICTURES"))
        ASSERT_TRUE(writePng(std::string(to) + "/voxel_panel_choice.png", pixels(), kWindow.x, kWindow.y));
    // The list opens under a click on it, and its second row is the mesh that moves, which holds no ball.
    bool other = false;
    for (float row = 70; row < 118 && !other; row += 6) {
        click(vec2(150, 53));
        click(vec2(150, row));
        other = count(materialColour(0)) > 1000 && count(materialColour(1)) < 100;
    }
    EXPECT_TRUE(other);
    rigid_.clear();
    frame(&field_, true);
    frame(&field_, true);
    EXPECT_GT(count(materialColour(1)), 1000U) << "the last there is";
}

}  // namespace
}  // namespace rivulet::voxel_panel_test
