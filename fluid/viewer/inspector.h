// Inspector: the measurements of a run, at the right of the window, one tab each: times, graphs, chart, frame graph, voxels. Closed at
// first; a hidden tab costs a few stored figures per step.
#pragma once

#include "engine/ui/frame_graph_panel.h"
#include "engine/ui/graph_panel.h"
#include "engine/ui/profiler_panel.h"
#include "engine/ui/timeline_panel.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "fluid/viewer/chart_panel.h"
#include "fluid/viewer/voxel_panel.h"

namespace rivulet {

class Inspector {
  public:
    enum class Tab { times, graphs, chart, frameGraph, voxels, none };

    Inspector();
    // After a step that took `ms` on the wall.
    void stepped(const Session& session, double ms);
    void clear();  // a new session begins
    // Needs a current OpenGL context. Returns whether `draft` was edited so that a new session is needed. `margin`: px around the window;
    // `room`: px, its largest width.
    bool draw(const Session& session, SceneRenderer& renderer, const Timeline& timeline, const ProfilerPanel& profiler, SceneFile& draft,
              float margin, float room);
    void hide(SceneRenderer& renderer);  // instead of draw(), in a frame without panels
    Tab shown() const { return shown_; }
    bool visible() const { return visible_; }
    void toggle() { visible_ = !visible_; }
    void show(Tab tab) {  // from the next frame on
        asked_ = tab;
        visible_ = true;
    }

    const GraphPanel& graphs() const { return graphs_; }
    const ChartPanel& chart() const { return chart_; }
    const FrameGraphPanel& frameGraph() const { return frameGraph_; }

  private:
    void askLedger(const Session& session);
    void anchor(float margin, float room);
    bool drawTab(const Session& session, SceneRenderer& renderer, const Timeline& timeline, const ProfilerPanel& profiler, SceneFile& draft,
                 float height);

    TimelinePanel timeline_;
    GraphPanel graphs_;
    ChartPanel chart_;
    FrameGraphPanel frameGraph_;
    VoxelPanel voxels_;
    Tab shown_ = Tab::none;  // in the last frame
    Tab open_ = Tab::times;  // the selected tab, shown or not
    Tab asked_ = Tab::none;  // to be opened
    // Of a scene with skins: its figures arrive some frames late.
    struct Ledgers {
        std::optional<RunStats::Ledger> last;
        bool asked = false;
    };
    std::shared_ptr<Ledgers> ledgers_ = std::make_shared<Ledgers>();
    int sinceAsked_ = 0;  // steps
    uint64_t frame_ = 0;  // of the figures last taken
    double time_ = 0;     // s simulated, of those
    vec2 corner_{0.0F};   // px: where its right edge and its top are
    float width_ = 0;     // px, of the last frame
    float shift_ = 0;     // px: how much wider it is than with the first tab
    float display_ = 0;   // px across
    bool narrow_ = false, visible_ = false;
};

}  // namespace rivulet
