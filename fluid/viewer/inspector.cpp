#include "fluid/viewer/inspector.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

// In the order of Inspector::Tab. `wide`: of the window, in heights of its letters.
constexpr struct {
    const char* name;
    float wide;
} kTabs[] = {{"times", 25}, {"graphs", 30}, {"chart", 33}, {"frame graph", 38}, {"voxels", 25}};

constexpr const char *kDensity = "density error", *kEnergy = "energy", *kParticles = "particles", *kLedger = "ledger",
                     *kLedgerError = "ledger error", *kSteps = "steps", *kStepLength = "step length";

// The graphs, and below in stepped() their figures: in the same order.
std::vector<GraphPanel::Graph> graphsOfARun() {
    return {
        {.name = kDensity,
         .unit = "%",
         .doc = "compression of the particles beyond the rest density",
         .series = {{"mean", "over all particles; 0 where a particle is not compressed"}, {"largest", "of all particles"}},
         .decades = true},
        {.name = kEnergy,
         .unit = "J",
         .doc = "of the particles; viscosity and impacts reduce the total; a gain comes from outside or is an error",
         .series = {{"kinetic", "sum of m v^2 / 2"}, {"potential", "sum of m g h; 0 at height 0"}, {"total", "kinetic plus potential"}}},
        {.name = kParticles,
         .unit = "",
         .doc = "the world's ledger, in its own unit",
         .series = {{"there", "all particles, lost ones included"},
                    {"emitted", "since the start, by blocks and emitters"},
                    {"drained", "since the start, by sinks"},
                    {"lost", "left the grid or became NaN; frozen and counted"}}},
        {.name = kLedger,
         .unit = "l",
         .doc = "all water, on skins and elsewhere",
         .series = {{"emitted", "since the start, by blocks, emitters and sources"},
                    {"on surface", "drops and films on skins"},
                    {"in air", "drops between skins, world and ground"},
                    {"in world", "particles, and the pending volume that makes no particle yet"},
                    {"evaporated", "since the start, from skins"},
                    {"drained", "since the start, by sinks and edges"}},
         .shown = false},
        {.name = kLedgerError,
         .unit = "%",
         .doc = "imbalance as a share of the emitted volume",
         .series = {{"error", "0 if volume is conserved"}},
         .unfolded = false,
         .shown = false},
        {.name = kSteps,
         .unit = "",
         .doc = "work per simulated frame",
         .series = {{"substeps", "a frame"}, {"iterations", "of the pressure solver per substep, mean; on a GPU some frames late"}}},
        {.name = kStepLength,
         .unit = "s",
         .doc = "simulated time of a substep",
         .series = {{"this frame", "mean of its substeps"}, {"shortest", "since the start"}, {"longest", "since the start"}}},
    };
}

}  // namespace

Inspector::Inspector() : graphs_(graphsOfARun()) {}

void Inspector::clear() {
    graphs_.clear();
    chart_.clear();
    voxels_.clear();
    ledgers_ = std::make_shared<Ledgers>();  // what is on its way is of the old one
    sinceAsked_ = 0;
    frame_ = 0;
    time_ = 0;
}

void Inspector::stepped(const Session& session, double ms) {
    const FluidWorld& world = session.world();
    const FluidStats& late = world.stats();
    const bool water = world.particles().count > 0;  // or drops on skins alone
    const double now = water ? late.time : world.time();
    if (session.replaying() != nullptr || now == time_) return;  // no new figures have arrived
    if (now < time_) clear();                                    // it began again
    const double seconds = now - time_;
    const bool next = water && late.frame == frame_ + 1 && late.substeps > 0;  // or the substeps are of the last of several frames
    frame_ = late.frame;
    time_ = now;
    if (water) chart_.stepped(world, ms, seconds);

    constexpr double kPercent = 100, kLitres = 1000;
    const double one = std::pow(double{world.params().spacing}, 3), lost = late.lost;
    const bool skins = !session.flows().empty();
    for (const char* name : {kLedger, kLedgerError}) graphs_.show(name, skins);
    for (const char* name : {kDensity, kEnergy, kParticles, kSteps, kStepLength}) graphs_.show(name, water || !skins);
    const double unknown = std::nan("");
    if (skins) askLedger(session);
    const RunStats::Ledger l =
        ledgers_->last.value_or(RunStats::Ledger{unknown, unknown, unknown, unknown, unknown, unknown, unknown, unknown});
    const double figures[] = {kPercent * late.avgCompression,
                              kPercent * late.maxCompression,
                              late.kinetic,
                              late.potential,
                              late.kinetic + late.potential,
                              static_cast<double>(late.particles),
                              late.emitted / one,
                              late.drained / one,
                              lost,
                              kLitres * l.emitted,
                              kLitres * l.onSurface,
                              kLitres * l.inAir,
                              kLitres * l.inWorld,
                              kLitres * l.evaporated,
                              kLitres * l.drained,
                              kPercent * l.error,
                              static_cast<double>(late.substeps),
                              late.iterations,
                              next ? seconds / late.substeps : unknown,
                              late.dtMin,
                              late.dtMax};
    graphs_.add(now, figures);
}

// Ten times a second, and only while the tab is open. On a GPU the world's figures are of another frame than those of the skins: they do
// not add up to the last drop, and the error is left out.
void Inspector::askLedger(const Session& session) {
    constexpr int kEvery = 6, kGiveUp = 60;  // steps: a device that is lost tells nothing
    if (shown_ != Tab::graphs) ledgers_->last.reset();
    if (shown_ != Tab::graphs || ++sinceAsked_ < (ledgers_->asked ? kGiveUp : kEvery)) return;
    sinceAsked_ = 0;
    ledgers_->asked = true;
    const FluidStats& late = session.world().stats();
    const double one = std::pow(double{session.world().params().spacing}, 3);
    const double inWorld = (static_cast<double>(late.particles) - late.lost) * one;
    const bool together = session.world().device().backend() == Backend::cpu;
    session.flows().ledgerLater([to = std::weak_ptr(ledgers_), late, inWorld, one, together](const SkinFlows::Ledger& skins) {
        const std::shared_ptr<Ledgers> into = to.lock();
        if (!into) return;
        into->asked = false;
        into->last = ledgerOf(late, inWorld, one, &skins);
        if (!together) into->last->error = std::nan("");
    });
}

void Inspector::hide(SceneRenderer& renderer) {
    shown_ = Tab::none;
    renderer.describe(false);
}

// A tab that needs another width leaves the right edge where it is, and so does a display that changes its size.
void Inspector::anchor(float margin, float room) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    if (width_ == 0) corner_ = vec2(display.x - margin, margin);
    if (display_ > 0) corner_.x += display.x - display_;
    const auto widthOf = [&](float wish) {
        return std::floor(std::max(std::min(wish, room / ImGui::GetFontSize()), 17.0F) * ImGui::GetFontSize());
    };
    const float wide = widthOf(kTabs[static_cast<size_t>(open_)].wide);
    shift_ = wide - widthOf(kTabs[0].wide);
    const float tall = std::max(display.y - 2 * margin, 80.0F);
    if (wide != width_ || display_ != display.x) ImGui::SetNextWindowPos(ImVec2(corner_.x, corner_.y), ImGuiCond_Always, ImVec2(1, 0));
    ImGui::SetNextWindowSizeConstraints(ImVec2(wide, 0), ImVec2(wide, tall));
    width_ = wide;
    display_ = display.x;
}

bool Inspector::draw(const Session& session, SceneRenderer& renderer, const Timeline& timeline, const ProfilerPanel& profiler,
                     SceneFile& draft, float margin, float room) {
    constexpr float kNarrow = 850;  // a window that becomes so narrow closes it: the picture comes first
    const bool narrow = ImGui::GetIO().DisplaySize.x < kNarrow;
    if (narrow && !narrow_ && display_ > 0 && asked_ == Tab::none) visible_ = false;
    narrow_ = narrow;
    shown_ = Tab::none;
    if (!visible_) {
        hide(renderer);
        return false;
    }
    if (asked_ != Tab::none) open_ = asked_;
    anchor(margin, room);
    bool recreate = false;
    if (ImGui::Begin("measurements###watch", &visible_, ImGuiWindowFlags_AlwaysAutoResize)) {
        // Their names stay where they are, whichever is open.
        const float left = ImGui::GetCursorPosX();
        ImGui::SetCursorPosX(left + shift_);
        if (ImGui::BeginTabBar("watched")) {
            for (size_t k = 0; k < std::size(kTabs); ++k) {
                const auto tab = static_cast<Tab>(k);
                const ImGuiTabItemFlags flags = asked_ == tab ? ImGuiTabItemFlags_SetSelected : ImGuiTabItemFlags_None;
                if (!ImGui::BeginTabItem(kTabs[k].name, nullptr, flags)) continue;
                open_ = shown_ = tab;
                ImGui::SetCursorPosX(left);
                const ImVec2 display = ImGui::GetIO().DisplaySize;
                const float used = ImGui::GetCursorPosY() + ImGui::GetStyle().WindowPadding.y;
                recreate = drawTab(session, renderer, timeline, profiler, draft, display.y - 2 * margin - used);
                ImGui::EndTabItem();
            }
            ImGui::EndTabBar();
        }
        const ImVec2 at = ImGui::GetWindowPos();
        corner_ = vec2(at.x + width_, at.y);
    }
    ImGui::End();
    asked_ = Tab::none;
    renderer.describe(shown_ == Tab::frameGraph);
    return recreate;
}

bool Inspector::drawTab(const Session& session, SceneRenderer& renderer, const Timeline& timeline, const ProfilerPanel& profiler,
                        SceneFile& draft, float height) {
    const float across = std::min(width_ - 2 * ImGui::GetStyle().WindowPadding.x, ImGui::GetContentRegionAvail().x);
    switch (shown_) {
        case Tab::times:
            timeline_.draw(timeline, 1.0e-3 * profiler.meanFrame(), across);
            ImGui::Spacing();
            profiler.draw(across);
            break;
        case Tab::graphs:
            graphs_.draw(across, height);
            break;
        case Tab::chart:
            return chart_.draw(session, draft, across, height);
        case Tab::frameGraph:
            if (renderer.description()) {
                frameGraph_.draw(*renderer.description(), renderer.times(), across);
            } else {
                ImGui::TextDisabled("no frame has been drawn yet");
            }
            break;
        case Tab::voxels:
            voxels_.draw(session.fields(), session.world().time(), across);
            break;
        case Tab::none:
            break;
    }
    return false;
}

}  // namespace rivulet
