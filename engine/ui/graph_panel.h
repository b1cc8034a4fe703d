// Live graphs: named figures over the last moments, those of one unit on one axis.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/ui/plot.h"

namespace rivulet {

class GraphPanel {
  public:
    struct Series {
        std::string name, doc;
    };
    struct Graph {
        std::string name, unit, doc;
        std::vector<Series> series;
        bool decades = false;  // by decades wherever its values span some
        bool unfolded = true;  // at first
        bool shown = true;
    };
    explicit GraphPanel(std::vector<Graph> graphs);

    // A figure of each series of all the graphs, in their order; NaN: unknown. `time`: s; one that is earlier than the last is of
    // another run, and all before it is forgotten.
    void add(double time, std::span<const double> values);
    void clear();
    void show(std::string_view graph, bool yes);
    size_t seriesCount() const { return rings_.size(); }

    // Inside an ImGui window, pixels: as many as there is room for without scrolling share `height`.
    void draw(float width, float height);

    struct Sample {
        double time = 0, value = 0;
    };
    std::vector<Sample> samples(std::string_view graph, std::string_view series) const;  // the oldest first; none: no such series

  private:
    static constexpr size_t kSamples = 600;
    // The visible part of a graph. Its axis follows the figures smoothly.
    struct View {
        PlotAxis target, shown;
        bool settled = false;  // shown has been target
    };
    struct Place {
        float left = 0, top = 0, width = 0, height = 0;  // pixels, of what is plotted
    };
    size_t at(size_t age) const { return (next_ + kSamples - 1 - age) % kSamples; }  // of the ring; age 0: the last
    double ringValue(size_t series, size_t age) const { return rings_[series][at(age)]; }
    float shareOf(double time) const { return static_cast<float>(1 + (time - times_[at(0)]) / span_); }  // across; 1: the last
    void follow(size_t graph);
    void drawGraph(size_t graph, float width, float height, bool last);
    void drawAxis(const View& view, const std::string& unit, const Place& place) const;
    void drawCurves(size_t graph, const Place& place) const;
    void drawLegend(size_t graph, float width) const;
    void drawTimes(const Place& place, bool told) const;
    size_t pointedAge() const;
    void drawTip(size_t graph, size_t age) const;

    std::vector<Graph> graphs_;
    std::vector<size_t> first_;  // of each graph's series, among all
    std::vector<View> views_;
    std::vector<double> times_ = std::vector<double>(kSamples);  // s; a ring
    std::vector<std::vector<double>> rings_;                     // of each series
    size_t next_ = 0, filled_ = 0;                               // where the next sample goes; how many there are
    double span_ = 1;                                            // s across
    double pointed_ = -1;   // share of the time shown that the mouse points at, in whichever graph; < 0: none
    double pointing_ = -1;  // the same, of the frame in the making
};

}  // namespace rivulet
