// A flow drawn into UV: height, slope and wetness, on any layout of charts. Drops are gathered in space, so that no seam is visible.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "fluid/flow/surface_flow.h"

namespace rivulet {

// The UV in `from` of each corner of the mesh's triangles, 3 a triangle: a place that makeFlowMesh has welded may have several UVs.
// `from` is the mesh of which `mesh` was made. Empty if it has no UVs.
std::vector<vec2> cornerUvs(const FlowMesh& mesh, const MeshView& from);

class FlowMaps {
  public:
    static constexpr int kLeastSize = 16, kMostSize = 8192;

    // `uvs`: 3 a triangle of the flow's mesh. `size`: texels of the map's edge, a power of two. The flow's device must outlive it.
    // Error (badInput): a wrong size, another number of UVs, UVs that cover no texel, a flow in thesis mode; (failed): out of memory.
    static Result<FlowMaps> create(const SurfaceFlow& flow, std::span<const vec2> uvs, int size);
    FlowMaps(FlowMaps&&) noexcept;
    FlowMaps& operator=(FlowMaps&&) noexcept;
    ~FlowMaps();

    // Updates texels(); `flow` is the flow that it was made for. Drops are drawn where the last step began, one step late. Before the first
    // step nothing is drawn. Does not wait.
    void draw(const SurfaceFlow& flow);

    // Where SurfaceFlow::hanging() is drawn apart, its drops can be left out: their feet remain, wet. By default they are caps as all
    // others.
    void leaveOutHanging(bool leaveOut);

    Device& device() const;
    int size() const;
    int mips() const;  // down to 1 x 1
    // Two uints a texel, four halves: slopes dh/du and dh/dv (m a unit of u, v), height of drops and film (mm), wetness (0 to 1). Rows from
    // v = 0 up, without gaps; mip after mip. Texels without skin are 0.
    const Buffer& texels() const;
    size_t texelsBefore(int mip) const;
    // A uint for every 8 x 8 texels, rows from v = 0 up: the number of the draw that last changed one of them. Behind them the same for
    // every texel of the mips above 3.
    const Buffer& stamps() const;
    uint32_t draws() const;  // so far

    size_t tiles() const;  // that contain skin

  private:
    struct Impl;
    explicit FlowMaps(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
