// Thesis mode of a flow: the same walk on the skin's UV layout taken as a flat mesh, cut at seams, with the force field (12)-(19) of the
// thesis, 2D SPH in UV and friction (20), (21). Velocities are UV/s: holding and speed depend on the layout.
#pragma once

#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/params.h"
#include "fluid/flow/flow_mesh.h"
#include "fluid/sim/world/step_context.h"
#include "shaders/flow/flow_step.h"
#include "shaders/flow/thesis_step.h"

namespace rivulet {

struct ThesisParams {
    float reach = 0.01F;          // UV, support radius h
    float restDensity = 0.016F;   // kg/UV^2
    float stiffness = 0.02F;      // UV^2/s^2, k of (4)
    float viscosity = 1.0e-4F;    // UV^2/s, of (6)
    float friction = 0.45F;       // mu of (21)
    float adhesive = 8.0e-6F;     // N, F_adhesive of (20)
    float curvature = 1.0e-6F;    // N kg/UV^3, k of (20)
    float curvatureMost = 1e-6F;  // N, limit of k / |grad rho|
    float windPush = 1.0F;        // 1/s: m/s^2 for each m/s of wind
    float disc = 0.012F;          // UV, radius of the disc (22) of the largest particle
    void visit(ParamVisitor& v);
};

// The neighbour across each edge, as FlowMesh::across, where the UVs of both sides agree; kOpen at seams. `uvs`: 3 a triangle.
std::vector<uint32_t> acrossInUv(const FlowMesh& mesh, std::span<const vec2> uvs);
vec2 uvAt(std::span<const vec2> uvs, const SkinPoint& at);
// m, height of a cap of `volume` (m^3) with this contact angle: the height that a particle's mass stands for.
double capHeight(double volume, double degrees);

// The tables and kernels of the mode. After the law, the flow's own kernels move particles.
class ThesisTables {
  public:
    // `uvs`: 3 a triangle. Error (badInput): not as many, or no triangle with an area in UV; out of memory.
    static Result<ThesisTables> create(Device& device, const FlowMesh& mesh, std::span<const vec2> uvs, const ThesisParams& params);

    void setParams(const ThesisParams& params);  // reach stays
    const ThesisParams& params() const { return params_; }
    Bounds around() const;  // UV, a layer as thick as a cell each side
    float cell() const;     // UV, edge of a cell of the sort
    const Buffer& skin() const { return skin_; }
    const Buffer& flat() const { return flat_; }

    // Buffers of the flow, as in the kernels of shaders/flow; skin, basis and drive are those in space.
    struct Of {
        const Buffer &skin, &basis, &drive;
        Buffer &drop, &motion, &merged;
        Particles& particles;
        NeighborGrid& grid;
    };
    // Computes (12)-(19); `bent`: M^-1 as well.
    void makeField(const Of& of, const FlowStep& f, bool bent);
    int parts(double seconds) const;  // substeps that pressure and viscosity need
    // Up to the law: `motion` is q, `merged` the holding force. Error (failed): no memory for the sort.
    Status press(const Of& of, const FlowStep& f, StepParams s);
    void releaseDrops(const Of& of, const FlowStep& f);  // after the walk

  private:
    ThesisStep stepOf(const FlowStep& f) const;

    Device* device_ = nullptr;
    ThesisParams params_;
    Bounds uvs_;
    uint32_t triangles_ = 0;
    Kernel frame_, field_, place_, law_, leave_;
    PairKernel density_, press_;
    Buffer skin_, flat_;      // of the layout: see flow/basis
    Buffer inverse_, force_;  // of each triangle
};

}  // namespace rivulet
