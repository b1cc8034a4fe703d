// The difference of two drawn surfaces, pixel by pixel, in degrees, particle radii and 255ths.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/render/frame_view.h"

namespace rivulet {

// A surface seen by a camera: one value per pixel, bottom row first.
struct SurfaceMap {
    int width = 0, height = 0;
    std::vector<float> depth;  // m along the view axis; 1e6: no surface
    std::vector<vec3> normal;  // view space, unit length; valid where there is depth
    bool there(size_t i) const { return depth[i] < 1.0e5F; }
};

// Computes the normals of a surface from its depths: the central difference of the points to both sides of a pixel, or, where the surface
// ends on one side, the difference to the other side. The renderer treats creases and outlines in a better way (slope() in shade.frag),
// which this does not. `radius`: m, of a drawn particle.
void fillNormals(SurfaceMap& map, const FrameView& view, float radius);

struct SurfaceErrors {
    // Degrees, over pixels where both have a surface. Spray and edges are few but far off: they dominate the mean and the rms, not the
    // median.
    double normalMean = 0, normalMedian = 0, normal95 = 0;
    double depthRms = 0, depthMedian = 0;  // radii, there
    double overlap = 0;                    // of the silhouettes: pixels in both over pixels in either; 1 if there are no pixels
    size_t pixels = 0;                     // where both have a surface
};
double angleBetween(const vec3& a, const vec3& b);  // degrees
SurfaceErrors compareSurfaces(const SurfaceMap& measured, const SurfaceMap& reference, float radius);

// Pixels in both over pixels in either; 1 if there are none.
double overlapOf(const std::vector<bool>& a, const std::vector<bool>& b);
// The pixels that have a covered one and one that is not within `reach` pixels of them, along rows and columns.
std::vector<bool> silhouetteBand(const std::vector<bool>& covered, int width, int reach);

constexpr int kSilhouettePixels = 2;

// How much more a picture changes from frame to frame than that of a reference: max(|change| - |change of the reference|, 0), mean over
// pixels and their channels, of 255. A surface that moves as the reference does has 0, wherever it is.
class UnexplainedChange {
  public:
    UnexplainedChange(int width, int height) : width_(width), pixels_(static_cast<size_t>(width) * static_cast<size_t>(height)) {}
    // Pictures as RGBA8; `covered`: the pixels with water in the measured one, in the same order.
    void add(std::span<const uint8_t> rgba, std::span<const uint8_t> reference, const std::vector<bool>& covered);
    double mean() const { return all_.mean(); }    // over the pixels with water in either frame; 0 before the second
    double edges() const { return edge_.mean(); }  // over those within 2 pixels of its silhouette in either frame

  private:
    struct Mean {
        double sum = 0, count = 0;
        double mean() const { return count > 0 ? sum / count : 0; }
    };
    int width_;
    size_t pixels_;
    std::vector<uint8_t> last_, lastReference_;
    std::vector<bool> lastCovered_, lastBand_;
    Mean all_, edge_;
};

// The rms difference of frames from their mean over time, over the pixels of `where` and their channels, of 255.
class Flicker {
  public:
    explicit Flicker(std::vector<bool> where) : where_(std::move(where)), sum_(3 * where_.size()), squares_(sum_.size()) {}
    void add(std::span<const uint8_t> rgba);
    double rms() const;  // 0 before the second frame

  private:
    std::vector<bool> where_;
    std::vector<double> sum_, squares_;
    int frames_ = 0;
};

}  // namespace rivulet
