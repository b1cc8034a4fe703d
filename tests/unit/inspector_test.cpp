// The window at the right, driven by InputEvents: its graphs show the session's figures, the points of its chart can be clicked, and its
// frame graph shows the drawn passes.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "engine/app/capture.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::inspector_test {
namespace {

class Watching : public testing::ViewerFixture {
  protected:
    static SceneFile damBreak() {
        SceneFile scene;
        scene.name = "dam break";
        scene.fluid.spacing = 0.05F;
        scene.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.4F, 0.6F, 0.5F)}};
        scene.look.renderer = "points";
        return scene;
    }
    void SetUp() override { input_.mouse = vec2(-100); }
    void begin(const SceneFile& scene, const ivec2& window, const ivec2& pixels) {
        ViewerFixture::begin(scene, window, pixels);
        viewer_->watch().toggle();  // closed at first
    }
    // Clicks on a tab, as it lies in the tab bar.
    void openTab(const char* name) {
        for (int k = 0; k < 3; ++k) frame();
        ImGuiContext& g = *ImGui::GetCurrentContext();
        vec2 middle(-1);
        for (int k = 0; k < g.TabBars.GetSize(); ++k) {
            const ImGuiTabBar& bar = *g.TabBars.GetByIndex(k);
            for (const ImGuiTabItem& tab : bar.Tabs)
                if (std::string_view(bar.TabsNames.c_str() + tab.NameOffset) == name)
                    middle = vec2(bar.BarRect.Min.x + tab.Offset + 0.5F * tab.Width, 0.5F * (bar.BarRect.Min.y + bar.BarRect.Max.y));
        }
        ASSERT_GT(middle.x, 0) << name;
        clickAt(middle);
        input_.mouse = vec2(-100);
        for (int k = 0; k < 3; ++k) frame();
    }
    static const ImGuiWindow* windowNamed(std::string_view end) {
        for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
            if (std::string_view(window->Name).ends_with(end)) return window;
        return nullptr;
    }
    void picture(const std::string& name) {
        const char* to = std::getenv("RIVULET_TEST_PICTURES");  // to be looked at
        if (to == nullptr) return;
        std::vector<uint8_t> texels(picture_.hostBytes()), flipped(texels.size());
        picture_.read(std::as_writable_bytes(std::span(texels)));
        const auto row = 4 * static_cast<std::ptrdiff_t>(picture_.width());
        for (int y = 0; y < picture_.height(); ++y) std::copy_n(texels.end() - (y + 1) * row, row, flipped.begin() + y * row);
        ASSERT_TRUE(writePng(std::string(to) + "/" + name + ".png", flipped, picture_.width(), picture_.height()));
    }

    static constexpr ivec2 kWindow{1280, 720}, kPixels{64, 36};
};

TEST_F(Watching, GraphsShowTheFiguresOfTheSession) {
    begin(damBreak(), kWindow, kPixels);
    openTab("graphs");
    EXPECT_EQ(viewer_->watch().shown(), Inspector::Tab::graphs);
    viewer_->session().reset();
    struct Said {
        FluidStats stats;
        double dt = 0;
    };
    std::vector<Said> said;
    for (int k = 0; k < 30; ++k) {
        const double before = viewer_->session().world().time();
        frame(1.0 / 60);
        const FluidWorld& world = viewer_->session().world();
        said.push_back({world.stats(), (world.time() - before) / world.lastSubsteps()});
    }
    const std::pair<std::pair<const char*, const char*>, std::function<double(const Said&)>> kSeries[] = {
        {{"density error", "mean"}, [](const Said& s) { return 100 * s.stats.avgCompression; }},
        {{"density error", "largest"}, [](const Said& s) { return 100 * s.stats.maxCompression; }},
        {{"energy", "kinetic"}, [](const Said& s) { return s.stats.kinetic; }},
        {{"energy", "potential"}, [](const Said& s) { return s.stats.potential; }},
        {{"energy", "total"}, [](const Said& s) { return s.stats.kinetic + s.stats.potential; }},
        {{"particles", "there"}, [](const Said& s) { return static_cast<double>(s.stats.particles); }},
        {{"particles", "emitted"}, [](const Said&) { return 8.0 * 12 * 10; }},  // the block's, 0.05 m apart
        {{"particles", "lost"}, [](const Said& s) { return static_cast<double>(s.stats.lost); }},
        {{"steps", "substeps"}, [](const Said& s) { return static_cast<double>(s.stats.substeps); }},
        {{"steps", "iterations"}, [](const Said& s) { return s.stats.iterations; }},
        {{"step length", "this frame"}, [](const Said& s) { return s.dt; }},
        {{"step length", "longest"}, [](const Said& s) { return s.stats.dtMax; }},
    };
    for (const auto& [name, figure] : kSeries) {
        const std::vector<GraphPanel::Sample> samples = viewer_->watch().graphs().samples(name.first, name.second);
        ASSERT_EQ(samples.size(), said.size()) << name.first << ", " << name.second;
        for (size_t k = 0; k < said.size(); ++k) {
            EXPECT_EQ(samples[k].time, said[k].stats.time);
            EXPECT_NEAR(samples[k].value, figure(said[k]), 1e-6 * std::abs(figure(said[k]))) << name.first << ", " << name.second;
        }
    }
    EXPECT_GT(said.back().stats.kinetic, 0.1) << "the water has moved";
    key(GLFW_KEY_R);
    frame(1.0 / 60);
    EXPECT_LE(viewer_->watch().graphs().samples("energy", "total").size(), 1U) << "what was before a reset is of another run";
}

// Rain on a ball: the graph equals the ledger of the skins, and volumes balance.
TEST_F(Watching, TheLedgersGraphIsTheLedger) {
    Result<SceneFile> scene = loadScene("rain_on_spot", std::vector<std::string>{"flow.0.mesh=meshes/sphere.obj", "flow.0.mapSize=64"});
    ASSERT_TRUE(scene) << scene.error().message;
    begin(*scene, kWindow, kPixels);
    input_.framebuffer = ivec2(0);  // the panels alone
    openTab("graphs");
    for (int k = 0; k < 40; ++k) frame(1.0 / 60);
    const GraphPanel& graphs = viewer_->watch().graphs();
    const auto last = [&](const char* series) { return graphs.samples("ledger", series).back().value; };
    const double emitted = last("emitted");
    EXPECT_GT(emitted, 0);
    EXPECT_NEAR(last("on surface") + last("in air") + last("in world") + last("evaporated") + last("drained"), emitted, 1e-9 * emitted);
    EXPECT_EQ(graphs.samples("ledger error", "error").back().value, 0);
    // It is asked for ten times a second: it was so within the last few steps.
    const SkinFlows::Ledger now = viewer_->session().flows().ledger();
    EXPECT_LE(emitted, 1000 * now.emitted);
    EXPECT_GT(emitted, 1000 * now.emitted * 30 / 40);
    openTab("times");
    frame(1.0 / 60);
    frame(1.0 / 60);
    EXPECT_TRUE(std::isnan(last("emitted"))) << "nobody looks at it";
}

// What falls freely and meets nothing keeps its energy: kinetic m (g t)^2 / 2, and the sum what it was.
TEST_F(Watching, TheEnergyOfAFallingBlockStaysAsItIs) {
    SceneFile scene = damBreak();
    scene.fluid.box = {.min = vec3(0), .max = vec3(1, 3, 1)};
    scene.fluid.blocks = {{.min = vec3(0.3F, 2.2F, 0.3F), .max = vec3(0.7F, 2.6F, 0.7F)}};
    begin(scene, kWindow, kPixels);
    openTab("graphs");
    viewer_->session().reset();
    for (int k = 0; k < 24; ++k) frame(1.0 / 60);
    const GraphPanel& graphs = viewer_->watch().graphs();
    const auto total = graphs.samples("energy", "total"), kinetic = graphs.samples("energy", "kinetic");
    ASSERT_EQ(total.size(), 24U);
    constexpr double kMass = 0.4 * 0.4 * 0.4 * 1000, kGravity = 9.81;  // kg, m/s^2
    const double whole = kMass * kGravity * 2.4;
    for (size_t k = 0; k < total.size(); ++k) {
        const double fell = kMass * std::pow(kGravity * kinetic[k].time, 2) / 2;
        EXPECT_NEAR(kinetic[k].value, fell, 0.02 * fell + 0.02) << kinetic[k].time;
        EXPECT_NEAR(total[k].value, whole, 0.01 * whole) << total[k].time;
    }
    EXPECT_GT(kinetic.back().value, 0.3 * whole);
}

TEST_F(Watching, AClickOnTheChartTakesItsMethodAndValues) {
    begin(damBreak(), kWindow, kPixels);
    for (int k = 0; k < 5; ++k) frame(1.0 / 60);
    key(GLFW_KEY_SPACE);
    openTab("chart");
    const ChartPanel& chart = viewer_->watch().chart();
    ASSERT_EQ(viewer_->scene().fluid.method, "pbf");
    for (const char* wanted : {"dfsph 3e-3, long steps", "wcsph", "pbf 6", "dfsph"}) {
        vec2 place(-1);
        for (const ChartPanel::Placed& p : chart.placed()) {
            if (p.row == nullptr || p.row->setting != wanted) continue;
            // One that no other hides.
            const bool alone = std::none_of(chart.placed().begin(), chart.placed().end(), [&](const ChartPanel::Placed& other) {
                return other.row != nullptr && other.row != p.row && glm::distance(other.at, p.at) < 5;
            });
            if (alone) place = p.at;
        }
        ASSERT_GT(place.x, 0) << wanted;
        clickAt(place);
        const ChartSetting& setting = *chartSettings().find(wanted);
        EXPECT_EQ(viewer_->scene().fluid.method, setting.method) << viewer_->message();
        SceneFile as = viewer_->scene();
        for (const std::string& assignment : assignmentsOf(setting.assignments))
            ASSERT_TRUE(setParam(assignment, [&as](ParamVisitor& v) { as.visit(v); }));
        EXPECT_EQ(as.fluid.pbf.iterations, viewer_->scene().fluid.pbf.iterations) << wanted;
        EXPECT_EQ(as.fluid.dfsph.tolerance, viewer_->scene().fluid.dfsph.tolerance) << wanted;
        EXPECT_EQ(as.fluid.dfsph.reach, viewer_->scene().fluid.dfsph.reach) << wanted;
        EXPECT_EQ(settingOf(viewer_->scene().fluid), &setting) << "and that is where the run is said to be";
        EXPECT_EQ(viewer_->scene().fluid.spacing, 0.05F) << "the number of particles was not asked for";
        EXPECT_EQ(viewer_->session().world().time(), 0) << "the water starts again";
        input_.mouse = vec2(-100);
        key(GLFW_KEY_PERIOD);
        EXPECT_GT(viewer_->session().world().stats().kinetic, 0);
        frame();
    }
}

// With a tick in its box a click takes the number of particles, too.
TEST_F(Watching, AClickMayTakeTheNumberOfParticles) {
    begin(damBreak(), kWindow, kPixels);
    frame(1.0 / 60);
    key(GLFW_KEY_SPACE);
    openTab("chart");
    const ChartPanel& chart = viewer_->watch().chart();
    const ImGuiWindow* window = windowNamed("###watch");
    ASSERT_NE(window, nullptr);
    const uint32_t few = viewer_->session().world().stats().particles;
    bool taken = false;
    for (float y = window->Pos.y + window->Size.y - 20; y > window->Pos.y + 0.5F * window->Size.y && !taken; y -= 12) {
        clickAt(vec2(window->Pos.x + 20, y));
        const auto point = std::find_if(chart.placed().begin(), chart.placed().end(), [](const auto& p) {
            return p.row != nullptr && p.row->setting == "pbf" && p.row->particles == 10240;
        });
        ASSERT_NE(point, chart.placed().end());
        clickAt(point->at);
        taken = viewer_->session().world().particles().count != few;
    }
    ASSERT_TRUE(taken);
    EXPECT_NEAR(viewer_->session().world().particles().count, 10240, 0.2 * 10240);
    EXPECT_NEAR(viewer_->scene().fluid.spacing, 0.05F * std::cbrt(few / 10240.0F), 1e-4F);
}

// The circle's caption names the cost at which the circle is drawn, on the axis of the chart's case.
TEST_F(Watching, TheChartsCaptionSaysWhereTheCircleIs) {
    begin(damBreak(), kWindow, kPixels);
    for (int k = 0; k < 20; ++k) frame(1.0 / 60);
    key(GLFW_KEY_SPACE);
    openTab("chart");
    const ChartPanel& chart = viewer_->watch().chart();
    const ChartPanel::Placed *low = nullptr, *high = nullptr, *run = nullptr;
    for (const ChartPanel::Placed& p : chart.placed()) {
        if (p.row == nullptr) run = &p;
        if (p.row != nullptr && (low == nullptr || p.at.x < low->at.x)) low = &p;
        if (p.row != nullptr && (high == nullptr || p.at.x > high->at.x)) high = &p;
    }
    ASSERT_TRUE(run != nullptr && low->at.x < high->at.x);
    const double share = (run->at.x - low->at.x) / (high->at.x - low->at.x);
    const double drawn = low->row->wallPerSecond * std::pow(high->row->wallPerSecond / low->row->wallPerSecond, share);
    EXPECT_NEAR(chart.here().cost, drawn, 0.02 * drawn);
    const std::string caption = ChartPanel::captionOf(chart.here(), "dam_break");
    EXPECT_NE(caption.find(readableFigure(chart.here().cost, "s")), std::string::npos) << caption;
    EXPECT_NE(caption.find(percentText(chart.here().densityError)), std::string::npos) << caption;
}

// The chart shows the cost and error of the run; a run with the cost of the chart's case lies on the point of that case.
TEST(ChartPanel, HereIsWhereTheRunIs) {
    const std::vector<ChartRow> chart = readChart(builtInChart());
    const ChartSetting* pbf = chartSettings().find("pbf");
    const ChartRow* row = rowLike(chart, "dam_break", pbf, "pbf", 9000);
    ASSERT_NE(row, nullptr);
    EXPECT_EQ(row->setting, "pbf");
    EXPECT_EQ(row->particles, 10240U);
    EXPECT_EQ(rowLike(chart, "dam_break", pbf, "pbf", 100)->particles, 5760U);
    EXPECT_EQ(rowLike(chart, "dam_break", nullptr, "dfsph", 9000)->setting, "dfsph") << "values of its own: the method as it comes";
    EXPECT_EQ(rowLike(chart, "dam_break", pbf, "none", 9000)->setting, "pbf");
    EXPECT_EQ(rowLike(chart, "no such case", pbf, "pbf", 9000), nullptr);

    ChartMeasured measured;
    constexpr double kFrame = 1.0 / 60;
    const double steps = row->stepsPerSecond * kFrame, ms = 1e3 * row->wallPerSecond * kFrame;
    for (int k = 0; k < 600; ++k)
        measured.add(ms * (1 + 0.1 * (k % 2 == 0 ? 1 : -1)), kFrame, row->particles, static_cast<int>(std::lround(steps)), 0.0123);
    const double rounded = std::lround(steps) / steps;
    EXPECT_NEAR(measured.wallPerSecond(), row->wallPerSecond, 0.01 * row->wallPerSecond);
    EXPECT_NEAR(measured.densityError(), 0.0123, 1e-9);
    EXPECT_NEAR(broughtTo(*row, measured) * rounded, row->wallPerSecond, 0.01 * row->wallPerSecond);

    SceneFile scene;
    for (const ChartSetting& setting : chartSettings().rows) {
        if (!setting.picked) continue;
        applySetting(setting, scene);
        EXPECT_EQ(settingOf(scene.fluid), &setting) << setting.name;
    }
    applySetting(*pbf, scene);
    scene.fluid.pbf.iterations = 5;
    EXPECT_EQ(settingOf(scene.fluid), nullptr);
}

TEST_F(Watching, TheFrameGraphShowsDrawnAndTimedPasses) {
    SceneFile scene = damBreak();
    scene.look.renderer = "screen_space";
    begin(scene, kWindow, kPixels);
    frame(1.0 / 60);
    key(GLFW_KEY_SPACE);
    frame();
    EXPECT_FALSE(viewer_->renderer().description()) << "nobody looks at it";
    openTab("frame graph");
    for (int k = 0; k < 8; ++k) frame();
    ASSERT_TRUE(viewer_->renderer().description());
    // The pool sums the passes of a name up; the panel has a row for each.
    std::set<std::string> timed, left, shown, shownLeft;
    for (const PassTime& pass : viewer_->renderer().times()) (pass.calls > 0 ? timed : left).insert(pass.name);
    for (const FrameGraphPanel::Row& row : viewer_->watch().frameGraph().rows())
        (row.figure == "culled" ? shownLeft : shown).insert(row.name);
    EXPECT_GT(timed.size(), 5U);
    EXPECT_EQ(shown, timed);
    EXPECT_TRUE(std::includes(shownLeft.begin(), shownLeft.end(), left.begin(), left.end()));
    for (const FrameGraphPanel::Row& row : viewer_->watch().frameGraph().rows()) EXPECT_FALSE(row.figure.empty()) << row.name;
    openTab("times");
    frame();
    EXPECT_FALSE(viewer_->renderer().description());
    key(GLFW_KEY_TAB);
    EXPECT_EQ(viewer_->watch().shown(), Inspector::Tab::none);
}

// Whatever is open lies within the window, beside the scene's panel; the right edge stays where it is when another tab is wider.
class EachTab : public Watching {
  protected:
    vec2 here() const {
        for (const ChartPanel::Placed& p : viewer_->watch().chart().placed())
            if (p.row == nullptr) return p.at;
        return vec2(-1);
    }
    void liesWithin(const ivec2& size) {
        const bool looked = std::getenv("RIVULET_TEST_PICTURES") != nullptr;
        SceneFile scene = damBreak();
        scene.fluid.spacing = looked ? 0.03F : 0.05F;
        scene.look.renderer = "screen_space";
        begin(scene, size, looked ? size : kPixels);
        input_.framebuffer = ivec2(0);
        for (int k = 0; k < (looked ? 240 : 20); ++k) frame(1.0 / 60);
        key(GLFW_KEY_SPACE);
        input_.framebuffer = looked ? size : kPixels;
        for (const char* tab : {"times", "graphs", "chart", "frame graph", "voxels"}) {
            openTab(tab);
            for (int k = 0; k < 6; ++k) frame();
            const ImGuiWindow *watch = windowNamed("###watch"), *left = windowNamed("###scene");
            ASSERT_TRUE(watch != nullptr && left != nullptr);
            EXPECT_NEAR(watch->Pos.x + watch->Size.x, static_cast<float>(size.x) - 10, 1) << tab;
            EXPECT_LE(watch->Pos.y + watch->Size.y, static_cast<float>(size.y)) << tab;
            EXPECT_GE(watch->Pos.x, left->Pos.x + left->Size.x) << tab;
            EXPECT_LE(watch->ContentSize.x, watch->InnerRect.GetWidth()) << tab << ": nothing is cut at its side";
            picture(std::string("watch_") + tab + "_" + std::to_string(size.y));
            // What is pointed at tells more.
            const vec2 where = std::string_view(tab) == "chart" ? here() : vec2(watch->Pos.x + 0.7F * watch->Size.x, watch->Pos.y + 130);
            input_.mouse = where;
            for (int k = 0; k < 3; ++k) frame();
            const ImGuiWindow* tip = windowNamed("Tooltip_00");
            if (std::string_view(tab) != "voxels") EXPECT_TRUE(tip != nullptr && tip->Active) << tab;
            picture(std::string("watch_") + tab + "_tip_" + std::to_string(size.y));
        }
    }
};
TEST_F(EachTab, LiesWithinASmallWindow) { liesWithin({1280, 720}); }
TEST_F(EachTab, LiesWithinALargeWindow) { liesWithin({1920, 1080}); }

}  // namespace
}  // namespace rivulet::inspector_test
