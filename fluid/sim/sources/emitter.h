// Emitters and sinks of a world: their Params, and the candidates that an emitter makes; source_passes.* turns those into particles.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/params.h"
#include "engine/core/result.h"
#include "fluid/sim/sources/block.h"
#include "fluid/sim/sources/dry.h"
#include "shaders/fluid/sources/emit_params.h"

namespace rivulet {

struct EmitterParams {
    std::string shape = "nozzle";  // nozzle | box | mesh
    float litresPerSecond = 1.0F;
    float speed = 0.0F;                                // m/s; of a nozzle 0 = what the rate needs through its opening
    vec3 position{0.0F, 1.0F, 0.0F};                   // m, the opening's centre, or the box's; mesh: where its origin goes
    vec3 direction{0.0F, -1.0F, 0.0F};                 // nozzle, box; any length but 0
    float radius = 0.05F;                              // m, nozzle
    vec3 size{0.2F};                                   // m, box
    std::string mesh = {};                             // file, as of a collider
    float fitSize = 0.0F;                              // m, mesh: its longest side; 0 = as it is
    vec3 rotation{0.0F};                               // deg, mesh
    float start = 0.0F, stop = 0.0F;                   // s; stop 0 = never
    std::string liquid = {};                           // a row of liquids(); "" = the world's
    vec3 dye{1.0F};                                    // linear; white = none
    float dyeAmount = 20.0F;                           // 1/m
    float dyeScattering = 0.0F;                        // 1/m
    std::vector<LiveAttributeParams> attributes = {};  // of its particles, as of BlockParams
    void visit(ParamVisitor& v);
};

// A volume in which particles are removed.
struct SinkParams {
    std::string shape = "box";  // box | sphere
    vec3 position{0.0F};        // m, its centre
    vec3 size{0.1F};            // m, box
    float radius = 0.05F;       // m, sphere
    void visit(ParamVisitor& v);
};

// An emitter with what it needs beyond its Params.
struct Emitter {
    EmitterParams params;
    std::vector<vec3>
        triangles;  // m, world: three corners each, of shape mesh; water comes out on the side from which they are anticlockwise
};

struct Sources {
    std::vector<Emitter> emitters = {};
    std::vector<SinkParams> sinks = {};
    std::vector<DryParams> dry = {};  // volumes without water
    double seconds = 10;              // how long emitters are expected to run: fluid.maxParticles = 0 makes room for that
    // m^3 that FluidWorld::deposit() is expected to bring in that time, beyond what withdraw() removes. 0: there is no such exchange.
    double expectedDeposit = 0;
    double more = 0;     // m^3 there is room for beyond all that
    uint32_t least = 0;  // particles there is room for at least, wherever they come from
    // At t = 0: particles in the box, about a spacing apart, in addition to those of fluid.blocks; and the triangles of fluid.blocks[k] of
    // shape mesh, three corners each (m).
    std::vector<NewParticle> particles = {};
    std::vector<std::vector<vec3>> blockTriangles = {};
};

// Volume an emitter has let out after `seconds`, m^3, if nothing blocks it.
double volumeAfter(const EmitterParams& params, double seconds);

// "", or the contradiction: a nozzle too narrow for its rate at its speed, a direction without length.
std::string contradiction(const EmitterParams& params);

// Particles that a nozzle lets out side by side; 0 of another shape.
double layerOf(const EmitterParams& params, float spacing);

// Makes an emitter's candidates, and keeps its accounts: every particle that is due is offered until it is taken.
class EmitterFeed {
  public:
    EmitterFeed(const Emitter& emitter, uint32_t index, float spacing);
    // Of water that others deposit, at any place.
    static EmitterFeed ofDeposits(uint32_t index, float spacing);
    void deposit(const vec3& place, const vec3& velocity, double volume);

    // Appends the particles that are due `seconds` after `time` (s), at most `most`, with their state at the end of that time.
    void offer(double time, double seconds, const vec3& gravity, size_t most, std::vector<Candidate>& to);
    // `count` of the offered were not taken: they stay in the backlog.
    void refuse(uint64_t count) { account_.refused += count; }
    // Other values: live ones, fixed ones stay. Where there is no memory for them nothing changes (std::bad_alloc leaves prepare()).
    struct Next {
        EmitterParams params;
        float speed = 0;
        std::array<std::vector<vec3>, 2> layers;
    };
    Next prepare(const EmitterParams& params) const;
    void take(Next next) noexcept;
    void reset();

    // Its accounts, for a saved state.
    struct Account {
        double due = 0;  // particles, since the start
        uint64_t offered = 0, refused = 0;
    };
    const Account& account() const { return account_; }
    // Of deposits: their places, and their mean velocity.
    struct Flight {
        std::array<vec3, 32> places{};  // m
        uint32_t count = 0, next = 0;   // of them; which is the oldest
        vec3 velocity{0.0F};            // m/s
    };
    const Flight& flight() const { return flight_; }
    void restore(const Account& account, const Flight& flight);

    const Emitter& emitter() const { return emitter_; }
    vec4 matter{1.0F, 1.0F, 0.0F, 0.0F}, absorption{0.0F};  // of its particles
    double due() const { return account_.due; }             // particles, since the start
    float fastest() const;                                  // m/s, of particles at the opening, at most

  private:
    EmitterFeed(uint32_t index, float spacing) : index_(index), spacing_(spacing) {}
    void offerDeposits(const vec3& gravity, size_t most, std::vector<Candidate>& to);
    void layOut(Next& to) const;
    vec3 onBox(uint64_t k) const;
    void onMesh(uint64_t k, vec3& p, vec3& normal) const;

    Emitter emitter_;
    uint32_t index_;
    float spacing_;
    float speed_ = 0;
    Account account_;
    std::array<std::vector<vec3>, 2>
        layers_;                 // m, nozzle: offsets of a layer's particles in the opening, one layer after the other in turn
    std::vector<double> areas_;  // mesh: running sum over the triangles
    bool deposits_ = false;
    Flight flight_;
};

}  // namespace rivulet
