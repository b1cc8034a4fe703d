// Times per pass, kept for some seconds and drawn as a graph with a table below it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/compute/device.h"

namespace rivulet {

class ProfilerPanel {
  public:
    // One frame's passes of one side, "simulate" or "render". Call for each side, then endFrame().
    void add(std::string_view side, std::span<const PassTime> passes);
    void endFrame(double frameMs);
    void draw(float width) const;  // pixels; inside an ImGui window
    void clear();

    // ms, of the last kMeanFrames frames: a side's passes; the whole frame on the wall.
    double mean(std::string_view side) const;
    double meanFrame() const;

  private:
    static constexpr int kFrames = 240, kMeanFrames = 30;
    struct Line {
        std::string side, name;
        std::vector<float> ms = std::vector<float>(kFrames, 0.0F);  // a ring
    };
    double meanOf(const std::vector<float>& ring) const;
    Line& line(std::string_view side, std::string_view name);
    void drawGraph(float across) const;
    void drawTable() const;
    void tell(float column) const;

    std::vector<Line> lines_;  // one a pass, in order of first sight
    std::vector<float> frame_ = std::vector<float>(kFrames, 0.0F);
    int at_ = 0, filled_ = 0;  // where the frame in the making is written
};

}  // namespace rivulet
