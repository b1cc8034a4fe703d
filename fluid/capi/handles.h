// What is behind rivulet.h's handles.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/gpu/host_state.h"
#include "fluid/capi/callbacks.h"
#include "fluid/capi/rivulet.h"
#include "fluid/flow/flow_layer.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/render/water_renderer.h"
#include "fluid/sim/world/fluid_world.h"

struct rivulet_context {
    rivulet::Log log;  // into hostLog
    rivulet::capi::HostLog hostLog;
    rivulet::GlFacts gl;
    std::unique_ptr<rivulet::Device> device;
    std::unique_ptr<rivulet::WaterRenderer> water;  // null: no OpenGL
    std::string name;
    std::map<std::string, rivulet::PassTime> passes;  // of the simulation, since rivulet_context_times() was called
    double deviceMs = 0;                              // of the simulation, since the start
    size_t memoryLimit = 0;                           // as rivulet_context_options
    int children = 0;                                 // worlds and skins
    void* current = nullptr;                          // the OpenGL context that it was created in; null: none, or not known
    bool busy = false;                                // a call is running
    rivulet::capi::Callback callback;                 // of that call
    std::optional<rivulet::gpu::HostState> hostGl;    // of that call, if it uses OpenGL
    bool plainState = false;                          // as rivulet_context_options::plain_state
    std::atomic<bool> stop = false;                   // of the device
};

namespace rivulet::capi {

void collectTimes(rivulet_context& context);  // adds what the device has reported to `passes` and `deviceMs`

// The sections of a scene file that a host's world has.
struct WorldParams {
    FluidParams fluid;
    std::vector<EmitterParams> emitters;
    std::vector<SinkParams> sinks;
    FluidLookParams look;
    void visit(ParamVisitor& v);
};

// A host's functions as a BodyHost.
struct BodyCallbacks {
    rivulet_context* context = nullptr;
    rivulet_body_host host{};
    std::string thrown;  // by one of them, in this call; the bodies then stay where they are
    std::vector<rivulet_body_load> loads;
    std::vector<rivulet_body_state> states;
};

}  // namespace rivulet::capi

struct rivulet_world {
    rivulet_context* context = nullptr;
    rivulet::capi::WorldParams params;
    std::vector<std::unique_ptr<rivulet::VoxelField>> fields;
    std::vector<rivulet::SolidRef> walls;  // what each is in the world
    std::vector<rivulet::Pose> poses;      // of the walls that move: the last requested
    std::unique_ptr<rivulet::capi::BodyCallbacks> callbacks;
    std::unique_ptr<rivulet::FreeBodies> free;
    std::unique_ptr<rivulet::FluidWorld> world;
    rivulet::FluidUpload upload;
    double deviceMs = 0;  // the context's, when this was last stepped
};

struct rivulet_skin {
    rivulet_context* context = nullptr;
    size_t vertices = 0;
    std::optional<rivulet::SurfaceFlow> flow;
    std::optional<rivulet::FlowMaps> maps;
    std::optional<rivulet::FlowLayer> layer;
    std::vector<rivulet::vec3> positions;
    rivulet::Buffer moved;                // a vec4 a vertex, copied from the host's buffer; empty before the first such step
    std::vector<rivulet::vec4> readBack;  // the same on its way to a device without OpenGL
    bool interrupted = false;             // its last step was: the drops are not valid any more
};
