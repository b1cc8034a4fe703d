// A frame's graph as a picture: passes down in their order, the memory that they share across, each resource a bar from its first pass to
// its last.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/gpu/frame_graph_description.h"

namespace rivulet {

class FrameGraphPanel {
  public:
    // `times`: of the passes, some frames late, those of one name in one row. Inside an ImGui window, pixels.
    void draw(const gpu::FrameGraphDescription& graph, std::span<const PassTime> times, float width);
    struct Row {
        std::string name, figure;  // "0.12", ms; "left out"; of the second and later passes of a name a ditto
    };
    const std::vector<Row>& rows() const { return rows_; }  // as last drawn

  private:
    struct Layout;
    void drawPass(const gpu::FrameGraphDescription& graph, size_t pass, const Layout& layout);
    void drawBars(const gpu::FrameGraphDescription& graph, const Layout& layout);
    void drawResources(const gpu::FrameGraphDescription& graph);
    void tellResource(const gpu::FrameGraphDescription& graph, size_t resource) const;

    std::vector<Row> rows_;
    std::vector<double> ms_;                           // of each pass, smoothed; < 0: not known
    size_t pointed_ = SIZE_MAX, pointing_ = SIZE_MAX;  // a resource under the mouse; in the frame in the making
};

}  // namespace rivulet
