// Inspector: what a run is doing, at the right of the window, a tab each: times, graphs, chart, frame graph, voxels. What is not shown
// costs nothing but a few figures kept of each step.
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
    // Needs a current OpenGL context. Whether `draft` was edited so that a new session is wanted. `margin`: px, about the window; `room`:
    // px across, that it may take.
    bool draw(const Session& session, SceneRenderer& renderer, const Timeline& timeline, const ProfilerPanel& profiler, SceneFile& draft,
              float margin, float room);
    void hide(SceneRenderer& renderer);  // it is not drawn in this frame
    Tab shown() const { return shown_; }
    void show(Tab tab) { asked_ = tab; }  // from the next frame on

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
    Tab open_ = Tab::times;  // that is or would be
    Tab asked_ = Tab::none;  // to be opened
    // Of a scene with skins, whose figures come late.
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
    bool narrow_ = false;
};

}  // namespace rivulet
