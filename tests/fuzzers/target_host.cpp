// Target host: any sequence of calls of the C interface, with any arguments that C can pass without lying about the size of an array.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <vector>

#include "engine/core/message_line.h"
#include "fluid/capi/rivulet.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {

constexpr size_t kMemory = size_t{256} << 20U;
constexpr std::array kScenes = {
    R"({"fluid": {"spacing": 0.06, "box": {"max": [0.6, 0.6, 0.6]}, "blocks": [{"max": [0.3, 0.3, 0.3]}]}})",
    R"({"fluid": {"method": "wcsph", "spacing": 0.06, "box": {"max": [0.6, 0.6, 0.6]}, "blocks": [{"max": [0.6, 0.12, 0.6]}], "sleep": {"on": true}}})",
    R"({"fluid": {"method": "dfsph", "spacing": 0.08, "box": {"max": [0.8, 0.8, 0.8]}}, "emitters": [{"position": [0.4, 0.6, 0.4], "litresPerSecond": 5}],
        "sinks": [{"position": [0.1, 0.0, 0.1], "size": [0.2, 0.1, 0.2]}]})",
    R"({"fluid": {"spacing": 0.06, "box": {"max": [0.6, 0.6, 0.6]}, "blocks": [{"max": [0.6, 0.18, 0.6]}], "foam": {"most": 50},
        "probes": [{"name": "wall"}, {"on": "body"}], "fixedStep": 0.01}})",
    "{}",
    R"({"fluid": {"spacing": -1}})",
    R"({"fluid": {"gravity": [3e38, 0, 0]}})"};
constexpr std::array kNames = {"fluid.gravity",  "fluid.artificialViscosity",  "fluid.viscosity",     "fluid.spacing",
                               "fluid.method",   "emitters.0.litresPerSecond", "emitters.0.position", "fluid.collision.friction",
                               "fluid.sleep.on", "fluid.maxSubsteps",          "sinks.0.size",        "look.smoothing"};

// What the host's rigid-body engine says of every body.
rivulet_body_state told{};
void advance(void* /*user*/, const rivulet_body_load* /*loads*/, const float* /*gravity*/, double /*seconds*/, rivulet_body_state* states,
             size_t count) {
    std::fill_n(states, count, told);
}
void reset(void* /*user*/, const rivulet_body_state* /*states*/, size_t /*count*/) {}
// The ids of the engine's own bodies: none is added twice, none is removed that it does not have.
std::vector<uint32_t> added{};
void bodyAdded(void* /*user*/, uint32_t id, const rivulet_body_state* state) {
    require(state != nullptr && std::find(added.begin(), added.end(), id) == added.end(), "a body is added once");
    added.push_back(id);
}
void bodyRemoved(void* /*user*/, uint32_t id) { std::erase(added, id); }
const rivulet_body_host kEngine{sizeof(rivulet_body_host), nullptr, advance, reset, bodyAdded, bodyRemoved, nullptr, nullptr, nullptr};

struct Host {
    rivulet_context* context = nullptr;
    rivulet_world* world = nullptr;
    rivulet_skin* skin = nullptr;
    rivulet_error why{};

    void judge(rivulet_status status) {
        require(status == RIVULET_OK || status == RIVULET_FAILED || status == RIVULET_BAD_INPUT, "a status is one of three");
        if (status != RIVULET_OK) {
            require(std::memchr(why.message, 0, sizeof why.message) != nullptr, "a message ends");
            require(messageLine(why.message, sizeof why.message) == why.message && why.message[0] != 0, "a message is one line of text");
        }
    }
    void call(Feed& feed, const std::string& file);
    void ask(uint32_t what, Feed& feed, const std::string& file);
    void makeWorld(Feed& feed);
    void makeSkin(Feed& feed);
};

void Host::makeWorld(Feed& feed) {
    rivulet_world_destroy(world);
    world = nullptr;
    added.clear();
    rivulet_world_options options{};
    options.size = sizeof options;
    const std::string own = feed.text(80);
    options.json = feed.u8() < 200 ? kScenes[feed.below(kScenes.size())] : own.c_str();
    std::array<float, 12> corners{};
    for (float& c : corners) c = feed.within(0.0F, 0.6F);
    corners[feed.below(12)] = feed.real();
    const std::array<uint32_t, 12> faces = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, feed.below(6)};
    rivulet_mesh wall{};
    wall.size = sizeof wall;
    wall.positions = corners.data();
    wall.vertices = 4;
    wall.indices = faces.data();
    wall.indices_count = feed.u8() < 8 ? 11 : 12;
    wall.friction = feed.u8() < 8 ? feed.real() : -1;
    wall.restitution = feed.u8() < 8 ? feed.real() : -1;
    wall.moves = feed.below(2);
    wall.resolution = static_cast<int32_t>(feed.below(24));
    if (feed.u8() < 8) wall.resolution = static_cast<int32_t>(feed.u32());
    wall.pose.rotation[3] = feed.u8() < 8 ? feed.real() : 1;
    options.walls = &wall;
    options.walls_count = feed.below(2);
    std::array<float, 24> samples{};
    for (float& s : samples) s = feed.u8() == 0 ? feed.real() : feed.within(-0.1F, 0.1F);
    rivulet_body body{};
    body.size = sizeof body;
    body.samples = samples.data();
    body.samples_count = 8;
    body.mass = feed.u8() < 16 ? feed.real() : 0.5F;
    body.inertia[0] = body.inertia[1] = body.inertia[2] = feed.u8() < 16 ? feed.real() : 1.0e-3F;
    body.volume = feed.u8() < 16 ? feed.real() : 1.0e-3F;
    for (float& x : body.pose.position) x = feed.u8() < 16 ? feed.real() : 0.3F;
    options.bodies = &body;
    options.bodies_count = feed.below(2);
    if (feed.u8() < 64) {
        options.body_host = &kEngine;
        told = {};
        for (float& x : told.pose.position) x = feed.u8() < 64 ? feed.real() : feed.within(0.0F, 0.6F);
        told.pose.rotation[3] = feed.u8() < 16 ? feed.real() : 1.0F;
        for (float& x : told.velocity) x = feed.u8() < 64 ? feed.real() : feed.within(-1.0F, 1.0F);
        told.spin[0] = feed.u8() < 32 ? feed.real() : 0.0F;
    }
    std::array<float, 30> places{};
    for (float& p : places) p = feed.u8() == 0 ? feed.real() : feed.within(0.0F, 0.6F);
    options.particles = places.data();
    options.particles_count = feed.below(11);
    judge(rivulet_world_create(context, &options, &world, &why));
}

void Host::makeSkin(Feed& feed) {
    rivulet_skin_destroy(skin);
    skin = nullptr;
    std::array<float, 12> corners{};
    for (float& c : corners) c = feed.u8() < 4 ? feed.real() : feed.within(-0.05F, 0.05F);
    std::array<float, 8> uvs{0, 0, 1, 0, 0, 1, 1, 1};
    uvs[feed.below(8)] = feed.real();
    const std::array<uint32_t, 6> faces = {0, 1, 2, 1, 3, feed.below(5)};
    rivulet_mesh mesh{};
    mesh.size = sizeof mesh;
    mesh.positions = corners.data();
    mesh.vertices = 4;
    mesh.indices = faces.data();
    mesh.indices_count = 6;
    mesh.uvs = uvs.data();
    rivulet_skin_options options{};
    options.size = sizeof options;
    options.mesh = &mesh;
    options.map_size = feed.u8() < 8 ? static_cast<int32_t>(feed.u32()) : 64;
    judge(rivulet_skin_create(context, &options, &skin, &why));
}

// The calls that change nothing.
void Host::ask(uint32_t what, Feed& feed, const std::string& file) {
    size_t count = 0;
    switch (what) {
        case 0:
            require(std::strlen(rivulet_context_device(context)) > 0 && std::strlen(rivulet_version()) > 0, "a device has a name");
            require(rivulet_context_memory(context) <= kMemory, "memory is limited");
            break;
        case 1: {
            std::array<rivulet_pass_time, 3> times{};
            judge(rivulet_context_times(context, times.data(), feed.below(4), &count, &why));
            break;
        }
        case 2: {
            rivulet_context_stop(context, 1);
            judge(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
            rivulet_context_stop(context, 0);
            break;
        }
        case 3: {
            std::array<rivulet_body_state, 2> states{};
            judge(rivulet_world_bodies(world, states.data(), feed.below(3), &why));
            break;
        }
        case 4: {
            std::array<rivulet_load, 2> loads{};
            judge(rivulet_world_loads(world, loads.data(), feed.below(3), &count, &why));
            break;
        }
        case 5: {
            std::array<rivulet_volume_count, 32> counts{};
            judge(rivulet_world_volume_events(world, counts.data(), feed.u8() < 32 ? 31 : 32, &count, &why));
            break;
        }
        case 6: {
            constexpr std::array kEndings = {".ply", ".vtp", ".csv", ".obj", ".txt", ""};
            const std::string path = file + kEndings[feed.below(kEndings.size())];
            judge(feed.u8() < 128 ? rivulet_world_export(world, path.c_str(), &why)
                                  : rivulet_world_export_surface(world, path.c_str(), &why));
            std::filesystem::remove(path);
            break;
        }
        case 7: {
            rivulet_buffers buffers{};
            buffers.size = sizeof buffers;
            judge(rivulet_world_buffers(world, &buffers, &why));
            break;
        }
        default: {
            uint32_t texture = 0;
            const rivulet_status got = rivulet_skin_texture(skin, &texture, &why);
            require(got != RIVULET_OK, "without OpenGL there is no texture");
            judge(got);
        }
    }
}

void Host::call(Feed& feed, const std::string& file) {
    std::array<float, 12> numbers{};
    for (float& n : numbers) n = feed.u8() < 40 ? feed.real() : feed.within(0.0F, 0.6F);
    const uint32_t what = feed.below(27);
    if (what >= 18) return ask(what - 18, feed, file);
    switch (what) {
        case 0:
            makeWorld(feed);
            break;
        case 1:
            makeSkin(feed);
            break;
        case 2:
        case 3:
        case 4: {
            rivulet_inputs inputs{};
            inputs.size = sizeof inputs;
            std::array<rivulet_pose, 2> poses{};
            for (rivulet_pose& p : poses) {
                std::copy_n(numbers.begin(), 3, p.position);
                std::copy_n(numbers.begin() + 3, 4, p.rotation);
            }
            inputs.gravity = feed.u8() < 128 ? numbers.data() : nullptr;
            inputs.poses = poses.data();
            inputs.poses_count = feed.below(3);
            judge(rivulet_world_step(world, feed.u8() < 128 ? &inputs : nullptr, feed.u8() < 16 ? double{feed.real()} : 1.0 / 60, &why));
            break;
        }
        case 5:
            judge(rivulet_world_reset(world, &why));
            break;
        case 6: {
            const std::string assignment = std::string(kNames[feed.below(kNames.size())]) + "=" + feed.text(24);
            judge(rivulet_world_set(world, assignment.c_str(), &why));
            break;
        }
        case 7: {
            rivulet_stats stats{};
            stats.size = sizeof stats;
            const rivulet_status got = rivulet_world_stats(world, &stats, &why);
            judge(got);
            if (got == RIVULET_OK) require(std::isfinite(stats.time) && std::isfinite(stats.kinetic), "statistics are finite");
            break;
        }
        case 8: {
            std::array<float, 90> positions{};
            rivulet_particles particles{};
            particles.size = sizeof particles;
            particles.capacity = feed.below(31);
            particles.positions = positions.data();
            const rivulet_status got = rivulet_world_particles(world, &particles, &why);
            judge(got);
            if (got == RIVULET_OK)
                for (const float p : positions) require(std::isfinite(p), "positions are finite");
            break;
        }
        case 9:
            judge(rivulet_world_save(world, (file + ".rstate").c_str(), &why));
            break;
        case 10:
            judge(rivulet_world_restore(world, (file + ".rstate").c_str(), &why));
            break;
        case 11: {
            std::array<rivulet_sample, 4> samples{};
            judge(rivulet_world_sample(world, numbers.data(), feed.below(5), samples.data(), &why));
            break;
        }
        case 12: {
            rivulet_ray ray{};
            std::copy_n(numbers.begin(), 3, ray.origin);
            std::copy_n(numbers.begin() + 3, 3, ray.direction);
            ray.reach = numbers[6];
            rivulet_hit hit{};
            judge(rivulet_world_cast(world, &ray, feed.below(2), &hit, &why));
            break;
        }
        case 13: {
            std::array<float, 4> heights{};
            judge(rivulet_world_heights(world, numbers.data(), feed.below(5), heights.data(), &why));
            break;
        }
        case 14: {
            std::array<rivulet_volume, 2> volumes{};
            for (rivulet_volume& v : volumes) {
                v.id = feed.below(3);
                v.shape = static_cast<int32_t>(feed.below(3));
                std::copy_n(numbers.begin(), 3, v.position);
                std::copy_n(numbers.begin() + 3, 3, v.size);
                v.radius = numbers[7];
            }
            judge(rivulet_world_set_volumes(world, volumes.data(), feed.below(3), &why));
            break;
        }
        case 15: {
            std::array<rivulet_volume_count, 2> counts{};
            size_t count = 0;
            judge(rivulet_world_volumes(world, counts.data(), feed.below(3), &count, &why));
            break;
        }
        case 16:
            judge(rivulet_skin_add(skin, numbers.data(), feed.u8() < 32 ? double{feed.real()} : 5.0, &why));
            break;
        default: {
            rivulet_skin_inputs inputs{};
            inputs.size = sizeof inputs;
            inputs.gravity = numbers.data();
            inputs.positions = feed.u8() < 64 ? numbers.data() : nullptr;
            judge(rivulet_skin_step(skin, &inputs, feed.u8() < 16 ? double{feed.real()} : 1.0 / 60, &why));
            rivulet_skin_stats stats{};
            stats.size = sizeof stats;
            judge(rivulet_skin_stats_of(skin, &stats, &why));
        }
    }
}

}  // namespace

void runHost(Bytes bytes) {
    Feed feed(bytes);
    const std::string file = fileOf({}, "_host");
    static Host host = [] {
        Host made;
        rivulet_context_options options{};
        options.size = sizeof options;
        options.backend = "cpu";
        options.memory_limit = kMemory;
        made.judge(rivulet_context_create(&options, &made.context, &made.why));
        require(made.context != nullptr, "there is a cpu");
        return made;
    }();
    host.makeWorld(feed);
    for (int k = 0; k < 12 && !feed.empty(); ++k) host.call(feed, file);
    rivulet_world_destroy(host.world);
    rivulet_skin_destroy(host.skin);
    host.world = nullptr;
    host.skin = nullptr;
    std::filesystem::remove(file + ".rstate");
}

std::vector<std::string> hostSeeds() {
    std::vector<std::string> all;
    for (int k = 0; k < 40; ++k) {
        std::string bytes(600, '\0');
        uint32_t state = static_cast<uint32_t>(k) * 2654435761U + 7;
        for (char& c : bytes) c = static_cast<char>((state = state * 1664525U + 1013904223U) >> 24U);
        all.push_back(bytes);
    }
    return all;
}

}  // namespace rivulet::fuzzers
