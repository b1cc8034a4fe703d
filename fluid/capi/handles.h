// What is behind rivulet.h's handles.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "engine/core/file_system.h"
#include "engine/core/jobs.h"
#include "engine/gpu/host_state.h"
#include "fluid/capi/bodies.h"
#include "fluid/capi/callbacks.h"
#include "fluid/capi/rivulet.h"
#include "fluid/capi/walls.h"
#include "fluid/flow/air_drops.h"
#include "fluid/flow/flow_layer.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/placed_flow.h"
#include "fluid/io/recording.h"
#include "fluid/render/backend.h"
#include "fluid/render/fluid_snapshot.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/render/water_renderer.h"
#include "fluid/sim/world/fluid_world.h"

struct rivulet_context {
    rivulet::Log log;  // into hostLog
    rivulet::capi::HostLog hostLog;
    rivulet::GlFacts gl;
    std::optional<rivulet::Workers> workers;  // without jobs of the host
    rivulet::Jobs jobs;
    std::unique_ptr<rivulet::Device> device;
    std::unique_ptr<rivulet::WaterRenderer> water;  // null: no OpenGL
    std::string name;
    std::map<std::string, rivulet::PassTime> passes;  // of the simulation, since rivulet_context_times() was called
    double deviceMs = 0;                              // of the simulation, since the start
    size_t memoryLimit = 0;                           // as rivulet_context_options
    std::atomic<int> children = 0;                    // worlds, skins and snapshots
    uint64_t skinsMade = 0;
    void* current = nullptr;                        // the OpenGL context that it was created in; null: none, or not known
    bool lost = false;                              // the OpenGL context has ended: rivulet_context_lost
    bool busy = false;                              // a call is running, of all but those that draw a snapshot
    std::atomic<bool> drawing = false;              // a call that uses OpenGL is running
    std::atomic<std::thread::id> drawer = {};       // the thread that draws a snapshot; none: of no thread
    rivulet::capi::Callback callback;               // of that call
    std::optional<rivulet::gpu::HostState> hostGl;  // of that call, if it uses OpenGL
    bool plainState = false;                        // as rivulet_context_options::plain_state
    std::atomic<bool> stop = false;                 // of the device
};

namespace rivulet::capi {

void collectTimes(rivulet_context& context);  // adds what the device has reported to `passes` and `deviceMs`

// The sections of a scene file that a host's world has.
struct WorldParams {
    FluidParams fluid;
    std::vector<EmitterParams> emitters;
    std::vector<SinkParams> sinks;
    std::vector<DryParams> dry;
    FluidLookParams look;
    void visit(ParamVisitor& v);
    void visitSources(ParamVisitor& v);  // emitters, sinks and dry volumes
};

}  // namespace rivulet::capi

struct rivulet_world {
    rivulet_context* context = nullptr;
    rivulet::capi::WorldParams params;
    rivulet::capi::Walls walls;
    rivulet::capi::Bodies bodies;
    std::unique_ptr<rivulet::FluidWorld> world;
    rivulet::FluidUpload upload;
    double deviceMs = 0;  // the context's, when this was last stepped
    // Of rivulet_world_step_skins: the drops in the air, the skins they fall from, s since the first such step.
    rivulet::AirDrops air;
    std::vector<uint64_t> skins;                            // their serials, in the order of the last such step
    std::vector<rivulet::vec4> fallingDrops, hangingDrops;  // as FluidView::drops and pendants
    double airTime = 0;
    bool exchanges = false;  // its water takes drops in
    std::optional<rivulet::RecordingWriter> recording;
    rivulet::RecordedFrame recorded;                                                 // memory of the last frame
    std::shared_ptr<rivulet_world*> alive = std::make_shared<rivulet_world*>(this);  // for answers that come later
};

struct rivulet_snapshot {
    rivulet_context* context = nullptr;
    rivulet::FluidSnapshot taken;
    rivulet::FluidLookParams look;  // of the world, then
    std::string liquid;
    rivulet::FluidUpload upload;
    std::atomic<bool> used = false;  // a call fills or draws it
    std::optional<rivulet::RecordingReader> recording;
    std::string recordingPath;
    rivulet::FileFacts recordingFacts;  // when it was opened
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
    // The skin's frame -> the world, before the present or last step and after it; in between it moves uniformly.
    struct Motion {
        rivulet::dmat4 before{1.0}, after{1.0};
        double begin = 0, seconds = 0;  // s
        rivulet::dmat4 at(double time) const;
    } motion;
    uint64_t steps = 0;
    uint64_t serial = 0;  // unlike that of all other skins of the context
    std::optional<rivulet::PlacedFlow> placed;
};
